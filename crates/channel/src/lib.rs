//! Clock, bounded pipelined channels, unit accounting

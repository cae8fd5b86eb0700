//! Tests of `cube3-host` from outside, one module each.

mod register_words;
mod registers;
mod setup_check;

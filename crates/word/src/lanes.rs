//! Running a loop over many lanes with the widest vectors that this processor has.

/// Runs `work` compiled for the processor's widest vector instructions (chosen once, at run time).
///
/// Everything that `work` calls must be `#[inline(always)]`, or it is compiled for the baseline. The
/// arithmetic is integer, so the result does not depend on the choice.
#[inline(always)]
pub fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}

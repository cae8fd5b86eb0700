//! Threads of a caller's choice.

use crate::{Error, Outcome};

/// Does some work on so many threads, in a pool of its own: no other work shares it, and nothing global is changed.
///
/// # Errors
/// Threads that cannot be started, and what the work gives.
///
/// ```
/// use cube3::{Error, on_threads};
///
/// let threads: usize = on_threads(2, || Ok::<usize, Error>(rayon::current_num_threads()))?;
/// assert_eq!(threads, 2);
/// # Ok::<(), Error>(())
/// ```
pub fn on_threads<R: Send, E: From<Error> + Send>(
    threads: usize,
    work: impl FnOnce() -> Result<R, E> + Send,
) -> Result<R, E> {
    pool(threads)?.install(work)
}

fn pool(threads: usize) -> Outcome<rayon::ThreadPool> {
    Ok(rayon::ThreadPoolBuilder::new().num_threads(threads).build()?)
}

//! Work that goes deep.

/// Bytes of stack for checking and evaluating: expressions within parts within calls go deep.
const STACK: usize = 256 << 20;

/// Does work on a stack that holds the deepest program. A panic goes on in the caller.
pub(crate) fn deep<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, work);
        let thread = thread.expect("the system gives a process one more thread");
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

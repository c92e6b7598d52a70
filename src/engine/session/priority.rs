//! Threads that render give way to the window's and to the graphics driver's, which may be
//! software on the same cores.

/// Steps of niceness: a thread that waits for input gets about ten times the share.
#[cfg(target_os = "linux")]
const NICENESS: i32 = 10;

/// Lowers the priority of the calling thread where the system has one for threads. A system that
/// refuses leaves all threads equal.
pub(super) fn lower() {
    // On Linux niceness belongs to threads; on other Unixes it is the whole process's.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::nice(NICENESS);
    #[cfg(any(windows, target_os = "macos"))]
    let _ = thread_priority::set_current_thread_priority(thread_priority::ThreadPriority::Min);
}

//! How far a picture is, on a terminal's standard error.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rt_lang::render::Control;
use rt_lang::report::printable_lines;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// How often the bar is drawn.
const PERIOD: Duration = Duration::from_millis(100);

/// What takes so long.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// Tracing, counted in samples.
    Tracing,
    /// Taking out noise.
    Denoising,
}

/// A bar that is drawn until this is dropped, which also wipes it.
pub struct Progress {
    finished: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Progress {
    /// Watches work on a picture of this name.
    pub fn watch(control: Arc<Control>, work: Work, name: String) -> Progress {
        let finished = Arc::new(AtomicBool::new(false));
        let seen = finished.clone();
        // Without a thread to draw it there is no bar, and nothing else is lost.
        let thread = std::thread::Builder::new().spawn(move || draw(&control, work, name, &seen)).ok();
        Progress { finished, thread }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.finished.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            // A panic in there has been reported by the hook.
            let _ = thread.join();
        }
    }
}

fn draw(control: &Control, work: Work, name: String, finished: &AtomicBool) {
    let start = Instant::now();
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    let style = ProgressStyle::with_template("{prefix} {bar:24} {percent:>3} %  {msg}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.set_prefix(printable_lines(&name));
    while !finished.load(Ordering::Relaxed) {
        let progress = control.progress();
        let elapsed = start.elapsed();
        // Of no work yet known, none is done.
        bar.set_length(progress.total.max(1));
        bar.set_position(progress.done);
        bar.set_message(message(work, progress.done, progress.total, elapsed));
        std::thread::park_timeout(PERIOD);
    }
    bar.finish_and_clear();
}

/// `12.3 M samples/s  4 s left`, or `denoising  4 s left`.
fn message(work: Work, done: u64, total: u64, elapsed: Duration) -> String {
    if done == 0 || elapsed.is_zero() {
        return if work == Work::Denoising { "denoising".into() } else { String::new() };
    }
    let rate = done as f64 / elapsed.as_secs_f64();
    let left = total.saturating_sub(done) as f64 / rate;
    let left = duration(Duration::from_secs_f64(left.min(1e9)));
    match work {
        Work::Tracing => format!("{:.2} M samples/s  {left} left", rate / 1e6),
        Work::Denoising => format!("denoising  {left} left"),
    }
}

/// A time as one says it: `850 ms`, `2.3 s`, `1 min 12 s`, `3 h 05 min`.
pub fn duration(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    let whole = seconds.round() as u64;
    match seconds {
        s if s < 0.9995 => format!("{:.0} ms", s * 1e3),
        s if s < 9.95 => format!("{s:.1} s"),
        s if s < 59.5 => format!("{s:.0} s"),
        s if s < 3599.5 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_read_well() {
        let said = |seconds| duration(Duration::from_secs_f64(seconds));
        assert_eq!(said(0.0123), "12 ms");
        assert_eq!(said(2.34), "2.3 s");
        assert_eq!(said(42.0), "42 s");
        assert_eq!(said(72.0), "1 min 12 s");
        assert_eq!(said(11_100.0), "3 h 05 min");
    }

    #[test]
    fn no_work_yet_says_nothing() {
        let said = |work, done| message(work, done, 3_000_000, Duration::from_secs(1));
        assert_eq!((said(Work::Tracing, 0), said(Work::Denoising, 0)), (String::new(), "denoising".into()));
        assert_eq!(said(Work::Tracing, 1_000_000), "1.00 M samples/s  2.0 s left");
        assert_eq!(said(Work::Denoising, 1_000_000), "denoising  2.0 s left");
    }
}

//! Writes pictures in the background: the newest, and no more often than it can.

use super::hub::Frame;
use crate::cli::Problem;
use crate::cli::build;
use crate::cli::interrupt::Interrupt;
use crate::cli::target::Target;
use crate::cli::terminal::Terminal;
use rt_lang::output::{Channels, Depth, Picture};
use std::sync::{Arc, Condvar, Mutex, PoisonError};

/// A picture to be written, and what is known of it.
pub struct Page {
    /// The picture.
    pub frame: Arc<Frame>,
    /// What to say when it is written.
    pub done: Option<String>,
}

/// Writes what it is given, in a thread of its own.
pub struct Writer {
    slot: Arc<(Mutex<Option<Page>>, Condvar)>,
}

impl Writer {
    /// One that writes to these places.
    pub fn start(
        targets: Vec<Target>,
        depth: Depth,
        interrupt: Interrupt,
        terminal: Terminal,
    ) -> Result<Writer, Problem> {
        let slot: Arc<(Mutex<Option<Page>>, Condvar)> = Arc::default();
        let own = slot.clone();
        let work = move || {
            loop {
                let page = next(&own);
                match write(&page, &targets, depth, &interrupt) {
                    Ok(()) => page.done.iter().for_each(|line| terminal.line(line)),
                    Err(problem) => terminal.problem(&problem),
                }
            }
        };
        let started = std::thread::Builder::new().name("write".into()).spawn(work);
        started.map_err(|error| Problem::new(format!("cannot start a thread: {error}")))?;
        Ok(Writer { slot })
    }

    /// Writes a picture as soon as it can, unless a newer one comes before.
    pub fn put(&self, page: Page) {
        *self.slot.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(page);
        self.slot.1.notify_one();
    }
}

fn next(slot: &(Mutex<Option<Page>>, Condvar)) -> Page {
    let mut held = slot.0.lock().unwrap_or_else(PoisonError::into_inner);
    loop {
        match held.take() {
            Some(page) => return page,
            None => held = slot.1.wait(held).unwrap_or_else(PoisonError::into_inner),
        }
    }
}

fn write(page: &Page, targets: &[Target], depth: Depth, interrupt: &Interrupt) -> Result<(), Problem> {
    let picture = picture(&page.frame);
    for target in targets {
        if let Some(reason) = target.format.refuses(picture.size) {
            return Err(Problem::new(reason.to_string()));
        }
        if let Some(reason) = picture.alpha.as_ref().and_then(|_| target.format.refuses_alpha()) {
            return Err(Problem::new(reason.to_string()));
        }
    }
    let staged = targets.iter().map(|target| target.stage(interrupt)).collect::<Result<Vec<_>, _>>()?;
    build::write(&picture, &page.frame.facts, &Channels::default(), depth, staged)
}

/// The picture of a frame of full size.
pub fn picture(frame: &Frame) -> Picture {
    let [width, height] = frame.size;
    let [columns, _] = frame.held();
    let at = |x: u32, y: u32| &frame.pixels[((y / frame.step) * columns + x / frame.step) as usize];
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let pixels = pixels.map(|(x, y)| {
        let [r, g, b, ..] = *at(x, y);
        [r, g, b]
    });
    let whole = Picture {
        size: frame.size,
        offset: [0, 0],
        whole: frame.size,
        pixels: pixels.collect(),
        alpha: None,
    };
    if frame.transparent { whole.with_alpha(|x, y| f64::from(at(x, y)[4])) } else { whole }
}

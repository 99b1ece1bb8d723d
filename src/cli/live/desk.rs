//! Where the thread that reads leaves work for the thread that traces.

use super::hub::{Known, Mask, Reply};
use crate::cli::scene::Loaded;
use rt_lang::render::{Control, Window};
use rt_lang::scene::Scene;
use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// A scene without errors, to be traced.
pub struct Job {
    /// Of its text, counted from 1.
    pub generation: u64,
    /// The scene with its texts.
    pub loaded: Loaded,
}

impl Job {
    /// The scene.
    ///
    /// # Panics
    ///
    /// If there were errors: then there is no job.
    pub fn scene(&self) -> &Scene {
        self.loaded.compiled.scene.as_ref().expect("a job is made of a scene without errors")
    }
}

/// What a trace is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// A first look, and whatever must be known before anything can be answered. It is not worth pausing.
    Short,
    /// Samples.
    Long,
}

/// What is asked of the picture that is being traced.
pub enum Question {
    /// Why a pixel looks as it does.
    Why {
        /// Column and row.
        pixel: [u32; 2],
        /// Whether to take all samples that there are.
        patient: bool,
        /// The answer, or why there is none.
        reply: Reply<Result<Known, String>>,
    },
    /// Which pixels show what stands at a place of a file.
    Light {
        /// The file as the user names it.
        file: String,
        /// Line and column, from 1; column 0 is the line's first word.
        place: [u32; 2],
        /// The pixels, or why there are none.
        reply: Reply<Result<Mask, String>>,
    },
}

impl Question {
    /// Whether nobody waits for an answer any more.
    fn is_forgotten(&self) -> bool {
        match self {
            Question::Why { reply, .. } => reply.is_closed(),
            Question::Light { reply, .. } => reply.is_closed(),
        }
    }
}

/// Questions that may wait.
const MOST_QUESTIONS: usize = 64;

/// Work that waits.
#[derive(Default)]
pub struct Desk {
    papers: Mutex<Papers>,
    news: Condvar,
}

#[derive(Default)]
struct Papers {
    next: Option<Arc<Job>>,
    /// What is different between that and the job that was taken last, as a person calls it.
    names: Vec<String>,
    first: Option<Window>,
    paused: bool,
    /// Paths wait while a text is compiled.
    reading: bool,
    /// Of the trace that is under way.
    control: Option<(Arc<Control>, Effort)>,
    /// Of an answer that is under way.
    answering: Option<Arc<Control>>,
    questions: VecDeque<Question>,
}

impl Desk {
    /// Leaves a job, in place of one that nobody has taken, with what is different from the one before; what is under way is to
    /// stop.
    pub fn put(&self, job: Arc<Job>, names: Vec<String>) {
        let mut papers = self.lock();
        papers.next = Some(job);
        for name in names {
            if !papers.names.contains(&name) {
                papers.names.push(name);
            }
        }
        let tracing = papers.control.iter().map(|(control, _)| control);
        tracing.chain(&papers.answering).for_each(|control| control.cancel());
        self.news.notify_all();
    }

    /// Takes the next job as soon as there is one, with what is different from the one that was taken before.
    pub fn take(&self) -> (Arc<Job>, Vec<String>) {
        let mut papers = self.lock();
        loop {
            match papers.next.take() {
                Some(job) => return (job, std::mem::take(&mut papers.names)),
                None => papers = self.wait(papers),
            }
        }
    }

    /// A handle for a trace that is about to begin; none where a new job waits.
    pub fn begin(&self, effort: Effort) -> Option<Arc<Control>> {
        let mut papers = self.lock();
        if papers.next.is_some() {
            return None;
        }
        let control = Arc::new(Control::new());
        papers.control = Some((control.clone(), effort));
        papers.hold();
        Some(control)
    }

    /// Waits until there is a new job or another wish for what comes first.
    pub fn rest(&self, first: Option<Window>) {
        let mut papers = self.lock();
        while papers.next.is_none() && papers.first == first {
            papers = self.wait(papers);
        }
    }

    /// Whether a new job waits.
    pub fn is_news(&self) -> bool {
        self.lock().next.is_some()
    }

    /// What is to be traced first.
    pub fn first(&self) -> Option<Window> {
        self.lock().first
    }

    /// Says what is to be traced first.
    pub fn put_first(&self, window: Option<Window>) {
        let mut papers = self.lock();
        papers.first = window;
        if let Some((control, _)) = &papers.control {
            control.cancel();
        }
        self.news.notify_all();
    }

    /// Lets paths wait, or go on.
    pub fn pause(&self, paused: bool) {
        let mut papers = self.lock();
        papers.paused = paused;
        papers.hold();
    }

    /// Lets paths wait while a text is read, so that it has the processor for itself.
    pub fn reading<T>(&self, read: impl FnOnce() -> T) -> T {
        let set = |reading| {
            let mut papers = self.lock();
            papers.reading = reading;
            papers.hold();
        };
        set(true);
        let read = read();
        set(false);
        read
    }

    /// A handle for an answer that takes a while; a new job cancels it.
    pub fn begin_answer(&self) -> Arc<Control> {
        let mut papers = self.lock();
        let control = Arc::new(Control::new());
        if papers.next.is_some() {
            control.cancel();
        }
        papers.answering = Some(control.clone());
        control
    }

    /// Leaves a question. Of too many the oldest is never answered.
    pub fn ask(&self, question: Question) {
        let mut papers = self.lock();
        papers.questions.push_back(question);
        if papers.questions.len() > MOST_QUESTIONS {
            papers.questions.pop_front();
        }
        self.news.notify_all();
    }

    /// The next question about the job under way; none once a new job waits.
    pub fn question(&self) -> Option<Question> {
        let mut papers = self.lock();
        loop {
            if papers.next.is_some() {
                return None;
            }
            match papers.questions.pop_front() {
                Some(question) if question.is_forgotten() => {}
                Some(question) => return Some(question),
                None => papers = self.wait(papers),
            }
        }
    }

    fn wait<'p>(&self, papers: MutexGuard<'p, Papers>) -> MutexGuard<'p, Papers> {
        self.news.wait(papers).unwrap_or_else(PoisonError::into_inner)
    }

    fn lock(&self) -> MutexGuard<'_, Papers> {
        // Every paper is whole at any time.
        self.papers.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Papers {
    fn hold(&self) {
        if let Some((control, effort)) = &self.control {
            control.pause(self.reading || self.paused && *effort == Effort::Long);
        }
    }
}

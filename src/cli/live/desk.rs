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
    /// What a person calls what is different from the text before.
    pub names: Option<String>,
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
        /// Line and column, from 1.
        place: [u32; 2],
        /// Nothing where nothing stands there.
        reply: Reply<Option<Mask>>,
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
    first: Option<Window>,
    paused: bool,
    /// Paths wait while a text is compiled.
    reading: bool,
    /// Of the trace that is under way.
    control: Option<Arc<Control>>,
    /// Of an answer that is under way.
    answering: Option<Arc<Control>>,
    questions: VecDeque<Question>,
}

impl Desk {
    /// Leaves a job, in place of one that nobody has taken; what is under way is to stop.
    pub fn put(&self, job: Arc<Job>) {
        let mut papers = self.lock();
        papers.next = Some(job);
        for control in papers.control.iter().chain(&papers.answering) {
            control.cancel();
        }
        self.news.notify_all();
    }

    /// Takes the next job as soon as there is one.
    pub fn take(&self) -> Arc<Job> {
        let mut papers = self.lock();
        loop {
            match papers.next.take() {
                Some(job) => return job,
                None => papers = self.wait(papers),
            }
        }
    }

    /// A handle for a trace that is about to begin; none where a new job waits.
    pub fn begin(&self) -> Option<Arc<Control>> {
        let mut papers = self.lock();
        if papers.next.is_some() {
            return None;
        }
        let control = Arc::new(Control::new());
        control.pause(papers.paused || papers.reading);
        papers.control = Some(control.clone());
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
        if let Some(control) = &papers.control {
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
        if let Some(control) = &self.control {
            control.pause(self.paused || self.reading);
        }
    }
}

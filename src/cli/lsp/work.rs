//! Where questions wait, and the threads that answer them.
//!
//! There are two: one for what a text means, and one for what can be told from the text alone, since who types waits for
//! a completion and not for an analysis. A question is dropped when it is cancelled, and while it is worked on, whoever
//! works asks from time to time whether it still matters.

use super::analyst::{Analyst, Looked, Meaning};
use super::diagnostics::{self, Found};
use super::documents::{Document, Key};
use super::requests::{Lane, Run};
use super::view::View;
use crossbeam_channel::Sender;
use gen_lsp_types::{LspRequestMethod, Uri};
use lsp_server::{ErrorCode, RequestId};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::Builder;

/// The stack of a thread that works: expressions go deep.
const STACK: usize = 64 << 20;

/// Why a question has no answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// As the protocol counts.
    pub code: i32,
    /// In a sentence.
    pub message: String,
}

impl Failure {
    /// With a code of the protocol.
    pub fn new(code: ErrorCode, message: impl Into<String>) -> Failure {
        Failure { code: code as i32, message: message.into() }
    }

    /// What was asked cannot be done, for a reason that a person understands.
    pub fn plain(message: impl Into<String>) -> Failure {
        Failure::new(ErrorCode::RequestFailed, message)
    }

    /// Nobody waits for it any more.
    pub fn cancelled() -> Failure {
        Failure::new(ErrorCode::RequestCanceled, "cancelled")
    }
}

/// An answer, or why there is none.
pub type Answer<T> = Result<T, Failure>;

/// A question that waits.
pub struct Question {
    /// Of the request.
    pub id: RequestId,
    /// What answers it.
    pub run: Run,
    /// What was asked.
    pub params: Value,
    /// What was known then.
    pub view: Arc<View>,
    /// Whether the client has lost interest.
    pub cancelled: Arc<AtomicBool>,
}

/// What a thread has to say.
pub enum Told {
    /// A question is answered: its request, the answer, and whether nobody waits for it any more.
    Answered(RequestId, Answer<Value>, Arc<AtomicBool>),
    /// A question has no answer yet, since what was known when it came means something else by now, though it was not edited.
    Unanswered(Lane, Question),
    /// Something for the client, by method and parameters.
    Notifies(String, Value),
    /// A question for the client.
    Asks(Ask),
    /// The client is gone.
    Gone,
    /// A document was looked at.
    Looked {
        /// Which.
        key: Key,
        /// What was known then.
        view: Arc<View>,
        /// The files it is made of.
        reads: BTreeSet<Key>,
        /// What is said of them.
        found: Found,
    },
}

/// A question for the client.
pub struct Ask {
    /// The request.
    pub method: String,
    /// Its parameters.
    pub params: Value,
    /// Who hears the answer, on the thread that hears all.
    pub heard: Heard,
}

/// Hears an answer of the client.
pub type Heard = Box<dyn FnOnce(Answer<Value>) + Send>;

impl Ask {
    /// One whose answer nobody waits for.
    pub fn new(method: LspRequestMethod, params: Value) -> Ask {
        Ask { method: method.as_str().into(), params, heard: Box::new(drop) }
    }

    /// The same, with somebody who waits.
    pub fn then(self, heard: impl FnOnce(Answer<Value>) + Send + 'static) -> Ask {
        Ask { heard: Box::new(heard), ..self }
    }
}

/// Where questions wait.
#[derive(Default)]
pub struct Desk {
    waiting: Mutex<Waiting>,
    news: Condvar,
}

#[derive(Default)]
struct Waiting {
    text: VecDeque<Question>,
    meaning: VecDeque<Question>,
    /// Documents to look at, with what was known when they changed last.
    changed: BTreeMap<Key, Arc<View>>,
    /// The one among them that was changed by hand.
    first: Option<Key>,
    /// Whether nobody listens any more.
    closed: bool,
}

/// Something to do.
enum Job {
    Question(Question),
    Look(Key, Arc<View>),
}

impl Desk {
    /// Starts the two threads, which tell what they have found.
    ///
    /// # Errors
    ///
    /// Where the system gives no more threads.
    pub fn start(told: &Sender<Told>) -> io::Result<Arc<Desk>> {
        let desk = Arc::new(Desk::default());
        for lane in [Lane::Text, Lane::Meaning] {
            let worker = Worker { desk: desk.clone(), told: told.clone(), analyst: Analyst::default() };
            Builder::new().name(format!("{lane:?}")).stack_size(STACK).spawn(move || worker.run(lane))?;
        }
        Ok(desk)
    }

    /// Puts a question.
    pub fn ask(&self, lane: Lane, question: Question) {
        let mut waiting = self.lock();
        match lane {
            Lane::Text => waiting.text.push_back(question),
            Lane::Meaning => waiting.meaning.push_back(question),
        }
        self.news.notify_all();
    }

    /// Asks for a look at documents that may mean something else now, at the first one before the others. All that wait are
    /// looked at as they are by then.
    pub fn look(&self, keys: impl IntoIterator<Item = Key>, view: &Arc<View>) {
        let mut waiting = self.lock();
        waiting.changed.values_mut().for_each(|waiting| *waiting = view.clone());
        let mut keys = keys.into_iter().peekable();
        waiting.first = keys.peek().cloned();
        waiting.changed.extend(keys.map(|key| (key, view.clone())));
        self.news.notify_all();
    }

    /// Ends the threads, as soon as they have done what they are at.
    pub fn close(&self) {
        self.lock().closed = true;
        self.news.notify_all();
    }

    /// Forgets a question that still waits.
    pub fn drop_question(&self, id: &RequestId) {
        let mut waiting = self.lock();
        waiting.text.retain(|question| question.id != *id);
        waiting.meaning.retain(|question| question.id != *id);
    }

    /// Waits for something to do; none at the end.
    fn next(&self, lane: Lane) -> Option<Job> {
        let mut waiting = self.lock();
        loop {
            if waiting.closed {
                return None;
            }
            let found = match lane {
                Lane::Text => waiting.text.pop_front().map(Job::Question),
                Lane::Meaning => waiting.next_of_meaning(),
            };
            match found {
                Some(job) => return Some(job),
                None => waiting = self.news.wait(waiting).unwrap_or_else(PoisonError::into_inner),
            }
        }
    }

    fn lock(&self) -> MutexGuard<'_, Waiting> {
        // Every change of it is one step.
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Waiting {
    /// Questions first: what they find out about a document is told as well.
    fn next_of_meaning(&mut self) -> Option<Job> {
        if let Some(question) = self.meaning.pop_front() {
            return Some(Job::Question(question));
        }
        let first = self.first.take().and_then(|key| self.changed.remove_entry(&key));
        first.or_else(|| self.changed.pop_first()).map(|(key, view)| Job::Look(key, view))
    }
}

/// A thread that answers.
struct Worker {
    desk: Arc<Desk>,
    told: Sender<Told>,
    analyst: Analyst,
}

impl Worker {
    /// Until nobody listens.
    fn run(mut self, lane: Lane) {
        while let Some(job) = self.desk.next(lane) {
            let told = match job {
                Job::Question(question) => Some(self.answer(lane, question)),
                Job::Look(key, view) => {
                    self.look(&key, &view);
                    None
                }
            };
            if told.is_some_and(|told| self.told.send(told).is_err()) {
                return;
            }
        }
    }

    fn answer(&mut self, lane: Lane, question: Question) -> Told {
        let again = AtomicBool::new(false);
        let Question { id, run, params, view, cancelled } = question;
        let kept = params.clone();
        let answer = self.work(|worker| {
            worker.analyst.keep(&view);
            run(&mut Asked { view: &view, cancelled: &cancelled, again: &again, worker }, params)
        });
        match answer.and_then(|answer| answer) {
            Err(failure)
                if failure.code == ErrorCode::ContentModified as i32 && again.load(Ordering::Relaxed) =>
            {
                Told::Unanswered(lane, Question { id, run, params: kept, view, cancelled })
            }
            answer => Told::Answered(id, answer, cancelled),
        }
    }

    fn look(&mut self, key: &Key, view: &Arc<View>) {
        let (cancelled, again) = (AtomicBool::new(false), AtomicBool::new(false));
        // What is out of date is looked at again soon.
        let _ = self.work(|worker| {
            worker.analyst.keep(view);
            let _ = Asked { view, cancelled: &cancelled, again: &again, worker }.meaning_of(key);
        });
    }

    /// Does something that may panic.
    fn work<T>(&mut self, work: impl FnOnce(&mut Worker) -> T) -> Answer<T> {
        let done = guarded(|| work(self));
        if done.is_err() {
            // What was being found out may be half known.
            self.analyst = Analyst::default();
        }
        done
    }
}

/// Does something that may panic, which is a bug: it is answered, and the server lives.
pub fn guarded<T>(work: impl FnOnce() -> T) -> Answer<T> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        let said = panic.downcast_ref::<&str>().map(ToString::to_string);
        let said = said.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
        Failure::new(ErrorCode::InternalError, format!("this is a bug in rtc: {said}"))
    })
}

/// What whoever answers a question knows.
pub struct Asked<'a> {
    /// What was known when it came.
    pub view: &'a Arc<View>,
    cancelled: &'a AtomicBool,
    /// Whether something was out of date that the client has not edited: it is asked about again as it is then.
    again: &'a AtomicBool,
    worker: &'a mut Worker,
}

impl Asked<'_> {
    /// An open document.
    pub fn document(&self, uri: &Uri) -> Answer<Arc<Document>> {
        let document = self.view.documents.get(&Key::of(uri));
        document.cloned().ok_or_else(|| not_open(uri))
    }

    /// What an open document means.
    pub fn meaning(&mut self, uri: &Uri) -> Answer<Arc<Meaning>> {
        self.meaning_of(&Key::of(uri)).unwrap_or_else(|| Err(not_open(uri)))
    }

    /// Whether the answer is no longer wanted, where it is about no document.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Whether the answer about a document is no longer wanted, and why.
    pub fn spoilt(&self, document: &Document) -> Option<Failure> {
        if self.is_cancelled() {
            return Some(Failure::cancelled());
        }
        if !document.is_stale() {
            return None;
        }
        self.again.store(!document.is_edited(), Ordering::Relaxed);
        Some(Failure::new(ErrorCode::ContentModified, "the document has changed"))
    }

    /// What a document means that is open, and tells what is new; none where it is not open.
    pub fn meaning_of(&mut self, key: &Key) -> Option<Answer<Arc<Meaning>>> {
        let (view, cancelled) = (self.view, self.cancelled);
        let document = view.documents.get(key)?;
        if let Some(failure) = self.spoilt(document) {
            return Some(Err(failure));
        }
        let stop = || cancelled.load(Ordering::Relaxed) || document.is_stale();
        let told = &self.worker.told;
        let tell = |looked: Looked| {
            let (reads, found) = diagnostics::looked(looked, key, view);
            let (key, view) = (key.clone(), view.clone());
            // Nobody listens at the end.
            let _ = told.send(Told::Looked { key, view, reads, found });
        };
        let meaning = match self.worker.analyst.meaning(view, key, document, &stop, tell) {
            Ok(meaning) => meaning,
            Err(failure) => return Some(Err(failure)),
        };
        let failure = || Failure::new(ErrorCode::ContentModified, "the document has changed");
        Some(meaning.ok_or_else(|| self.spoilt(document).unwrap_or_else(failure)))
    }
}

fn not_open(uri: &Uri) -> Failure {
    Failure::new(ErrorCode::InvalidParams, format!("`{uri}` is not open"))
}

#[cfg(test)]
mod tests {
    use super::super::client::Client;
    use super::super::document::Encoding;
    use super::super::documents::Documents;
    use super::super::pages::Pages;
    use super::super::view::Session;
    use super::*;
    use serde_json::json;

    #[test]
    fn a_panic_is_an_answer() {
        let failed = guarded(|| -> u32 { panic!("at {}", 7) }).unwrap_err();
        assert_eq!(failed.code, ErrorCode::InternalError as i32);
        assert!(failed.message.ends_with("at 7"), "{}", failed.message);
        assert_eq!(guarded(|| 4), Ok(4));
    }

    /// What is known where these are open.
    fn view(documents: &Documents) -> Arc<View> {
        let session = Session {
            client: Client::default(),
            encoding: Encoding::Utf16,
            root: None,
            pages: Pages::default(),
            memory: Arc::default(),
        };
        Arc::new(View { session: Arc::new(session), documents: documents.clone(), folders: vec![] })
    }

    #[test]
    fn behind_a_panic_the_next_question_is_answered() {
        let (tell, told) = crossbeam_channel::bounded(8);
        let desk = Desk::start(&tell).unwrap();
        let view = view(&Documents::default());
        let ask = |lane: Lane, id: i32, run: Run| {
            let (params, cancelled) = (Value::Null, Arc::default());
            desk.ask(lane, Question { id: id.into(), run, params, view: view.clone(), cancelled });
        };
        for lane in [Lane::Text, Lane::Meaning] {
            ask(lane, 1, |_, _| panic!("oh"));
            ask(lane, 2, |_, _| Ok(Value::Null));
            let answers = [told.recv(), told.recv()].map(|told| match told {
                Ok(Told::Answered(id, answer, _)) => (id, answer.map_err(|failure| failure.code)),
                _ => panic!("no answer"),
            });
            let wrong: Result<Value, i32> = Err(ErrorCode::InternalError as i32);
            assert_eq!(answers, [(RequestId::from(1), wrong), (RequestId::from(2), Ok(Value::Null))]);
        }
    }

    #[test]
    fn a_question_about_what_was_not_edited_is_put_again() {
        let (tell, told) = crossbeam_channel::bounded(8);
        let desk = Desk::start(&tell).unwrap();
        let mut documents = Documents::default();
        let key = documents.open("untitled:a".to_string().into(), 1, "sphere {}".into());
        let before = view(&documents);
        let ask = |view: &Arc<View>| {
            let run: Run = |asked, params| {
                let uri = "untitled:a".to_string().into();
                asked.meaning(&uri).map(|_| params)
            };
            let (params, cancelled, view) = (json!(7), Arc::default(), view.clone());
            desk.ask(Lane::Meaning, Question { id: 1.into(), run, params, view, cancelled });
            loop {
                match told.recv().unwrap() {
                    Told::Looked { .. } => {}
                    other => return other,
                }
            }
        };
        // Something that it reads is another.
        documents.touch(&key);
        let Told::Unanswered(Lane::Meaning, question) = ask(&before) else { panic!("answered") };
        assert_eq!((question.id, question.params), (1.into(), json!(7)));
        let now = view(&documents);
        let Told::Answered(_, Ok(answer), _) = ask(&now) else { panic!("not answered") };
        assert_eq!(answer, json!(7));
        documents.open("untitled:a".to_string().into(), 2, "sphere {}".into());
        let Told::Answered(_, Err(failure), _) = ask(&now) else { panic!("answered") };
        assert_eq!(failure.code, ErrorCode::ContentModified as i32);
    }
}

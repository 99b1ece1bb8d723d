//! Making the picture of a document, saved or not, beside where it is saved.

use super::analyst::Meaning;
use super::commands::{Order, has};
use super::documents::Key;
use super::work::{Answer, Ask, Failure, Told};
use super::world::World;
use crate::cli::Problem;
use crate::cli::build::{self, refuse_inputs_as_outputs};
use crate::cli::target::Target;
use gen_lsp_types as lsp;
use lsp::LspNotificationMethod as Notified;
use lsp_server::RequestId;
use rt_lang::compile;
use rt_lang::diagnostic::Severity;
use rt_lang::lower::Overrides;
use rt_lang::render::Control;
use rt_lang::source::Sources;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How often is told how far it is.
const PERIOD: Duration = Duration::from_millis(100);
/// What tokens of progress begin with; the id of the request follows, as JSON has it.
const TOKEN: &str = "rtc.render ";

/// Makes it, and says where it is.
pub fn render(order: &Order) -> Answer<Value> {
    let Order { view, key, about, interrupt, cancelled, .. } = order;
    if cancelled.load(Ordering::Relaxed) {
        return Err(Failure::cancelled());
    }
    let path = key.path().ok_or_else(|| Failure::plain("save it first: its picture goes beside it"))?;
    let target = Target::beside(path);
    let world = World::around(view, key);
    let source = world.source().map_err(|_| Failure::plain("the document cannot be read"))?;
    let mut sources = Sources::default();
    let id = sources.add(source);
    let mut options = view.session.options();
    options.overrides = Overrides { camera: about.camera.clone(), ..Overrides::default() };
    let compiled = compile(&world, &mut sources, id, &options);
    let wrong = |problem: Problem| Failure::plain(problem.message);
    let read = world
        .asked()
        .iter()
        .filter_map(Key::path)
        .map(PathBuf::from)
        .chain([path.into()])
        .collect::<Vec<_>>();
    refuse_inputs_as_outputs(&read, std::slice::from_ref(&target.path)).map_err(wrong)?;
    let Some(from) = compiled.provenance(&sources) else {
        if let Some(camera) = &about.camera
            && let Some(meaning) = Meaning::find(view, key, &|| cancelled.load(Ordering::Relaxed))
        {
            has(&meaning, camera)?;
        }
        let mut errors = compiled.diagnostics.iter().filter(|said| said.severity() == Severity::Error);
        let first = errors.next().map_or("it is not finished", |error| error.message.as_str());
        return Err(Failure::plain(match errors.count() {
            0 => format!("the scene has an error: {first}"),
            more => format!("the scene has {} errors, the first: {first}", more + 1),
        }));
    };
    let control = Arc::new(Control::new());
    let name = target.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let made = beside(order, &control, &name, || build::make(from, &target, &control, interrupt));
    match made {
        Ok(Some(())) => {
            tell(
                order,
                Notified::WindowShowMessage,
                json!({ "type": 3, "message": format!("{name} is made") }),
            );
            Ok(json!({ "path": target.path.display().to_string() }))
        }
        Ok(None) => Err(Failure::cancelled()),
        Err(problem) => Err(wrong(problem)),
    }
}

/// Does the work, and beside it tells how far it is and looks whether it is still wanted.
fn beside<T>(order: &Order, control: &Control, name: &str, work: impl FnOnce() -> T) -> T {
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let watcher = scope.spawn(|| watch(order, control, name, &done));
        let made = work();
        done.store(true, Ordering::Relaxed);
        watcher.thread().unpark();
        made
    })
}

fn watch(order: &Order, control: &Control, name: &str, done: &AtomicBool) {
    let token = token(&order.id);
    let progress = |value: Value| tell(order, Notified::Progress, json!({ "token": token, "value": value }));
    // Nothing is told under a token before the client has taken it.
    let create = Ask::new(lsp::LspRequestMethod::WindowWorkDoneProgressCreate, json!({ "token": token }));
    let (agreed, mut begun) = (Arc::new(AtomicBool::new(false)), false);
    let agrees = agreed.clone();
    let create = create.then(move |answer| agrees.store(answer.is_ok(), Ordering::Relaxed));
    if order.view.session.client.progress {
        let _ = order.told.send(Told::Asks(create));
    }
    while !done.load(Ordering::Relaxed) {
        if order.cancelled.load(Ordering::Relaxed) {
            control.cancel();
        }
        let far = control.progress();
        let percentage = 100 * far.done / far.total.max(1);
        if begun {
            progress(json!({ "kind": "report", "percentage": percentage }));
        } else if agreed.load(Ordering::Relaxed) {
            begun = true;
            progress(
                json!({ "kind": "begin", "title": name, "cancellable": true, "percentage": percentage }),
            );
        }
        std::thread::park_timeout(PERIOD);
    }
    if begun {
        progress(json!({ "kind": "end" }));
    }
}

/// What the progress of a request is told under.
fn token(id: &RequestId) -> String {
    format!("{TOKEN}{}", json!(id))
}

/// The request whose progress is told under a token; none under one that was not given here.
pub fn request_of(token: &lsp::ProgressToken) -> Option<RequestId> {
    let lsp::ProgressToken::String(token) = token else { return None };
    serde_json::from_str(token.strip_prefix(TOKEN)?).ok()
}

fn tell(order: &Order, method: Notified, params: Value) {
    let _ = order.told.send(Told::Notifies(method.as_str().into(), params));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_leads_to_its_request() {
        for id in [RequestId::from(-7), "7".to_string().into(), "a \"b\"\n\u{0}é".to_string().into()] {
            assert_eq!(request_of(&lsp::ProgressToken::String(token(&id))), Some(id));
        }
        assert_eq!(request_of(&lsp::ProgressToken::Int(7)), None);
        assert_eq!(request_of(&lsp::ProgressToken::String("rtc.render ".into())), None);
    }
}

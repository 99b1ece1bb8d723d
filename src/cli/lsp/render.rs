//! Making the picture of a document, saved or not, beside where it is saved.

use super::commands::Order;
use super::work::{Answer, Failure, Told};
use super::world::World;
use crate::cli::build;
use crate::cli::target::Target;
use gen_lsp_types as lsp;
use lsp::LspNotificationMethod as Notified;
use rt_lang::compile;
use rt_lang::diagnostic::Severity;
use rt_lang::lower::Overrides;
use rt_lang::render::Control;
use rt_lang::source::Sources;
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How often is told how far it is.
const PERIOD: Duration = Duration::from_millis(100);

/// Makes it, and says where it is.
pub fn render(order: &Order) -> Answer<Value> {
    let Order { view, key, about, interrupt, .. } = order;
    let path = key.path().ok_or_else(|| Failure::plain("save it first: its picture goes beside it"))?;
    let target = Target::beside(path);
    let world = World::around(view, key);
    let source = world.source().map_err(|_| Failure::plain("the document cannot be read"))?;
    let mut sources = Sources::default();
    let id = sources.add(source);
    let mut options = view.session.options();
    options.overrides = Overrides { camera: about.camera.clone(), ..Overrides::default() };
    let compiled = compile(&world, &mut sources, id, &options);
    let errors = compiled.diagnostics.iter().filter(|said| said.severity() == Severity::Error).count();
    let from = compiled.provenance(&sources).ok_or_else(|| match errors {
        1 => Failure::plain("the scene has an error"),
        errors => Failure::plain(format!("the scene has {errors} errors")),
    })?;
    let control = Control::new();
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
        Err(problem) => Err(Failure::plain(problem.message)),
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
    let token = format!("rtc.render {}", order.id);
    let shows = order.view.session.client.progress;
    let progress = |value: Value| {
        if shows {
            tell(order, Notified::Progress, json!({ "token": token, "value": value }));
        }
    };
    if shows {
        let params = json!({ "token": token });
        let method = lsp::LspRequestMethod::WindowWorkDoneProgressCreate.as_str();
        let _ = order.told.send(Told::Asks(method.into(), params));
    }
    progress(json!({ "kind": "begin", "title": name, "percentage": 0 }));
    while !done.load(Ordering::Relaxed) {
        if order.cancelled.load(Ordering::Relaxed) {
            control.cancel();
        }
        let far = control.progress();
        progress(json!({ "kind": "report", "percentage": 100 * far.done / far.total.max(1) }));
        std::thread::park_timeout(PERIOD);
    }
    progress(json!({ "kind": "end" }));
}

fn tell(order: &Order, method: Notified, params: Value) {
    let _ = order.told.send(Told::Notifies(method.as_str().into(), params));
}

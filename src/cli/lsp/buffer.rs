//! The text of a document, for the preview that changes it: in the editor as long as it is open there, and in its file
//! otherwise.
//!
//! An editor may have gone on when it is asked to change a text. So it is told of which version the change is, and of no
//! version it is asked for two.

use super::documents::{Document, Kept, Key};
use super::edits::{least, workspace};
use super::preview::{Newest, lock};
use super::view::View;
use super::work::{Answer, Ask, Told};
use crate::cli::live::store::{CHANGING, Done, Saved, Store};
use crossbeam_channel::Sender;
use gen_lsp_types as lsp;
use serde_json::json;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// By document the edit behind which the editor was asked to change it.
pub type Asked = Arc<Mutex<BTreeMap<Key, u64>>>;

/// What the editor calls a change where it lists them.
const LABEL: &str = "Written in the preview";

/// The text of a document.
pub struct Buffer {
    /// Which.
    pub key: Key,
    /// Its file.
    pub saved: Saved,
    /// What is open now.
    pub newest: Newest,
    /// What the editor was asked already.
    pub asked: Asked,
    /// Who asks it.
    pub told: Sender<Told>,
}

impl Buffer {
    /// Has the editor change the text; why it will not, where that is known at once.
    fn ask(&self, view: &View, document: &Document, before: &str, after: &str, done: Done) {
        if !view.session.client.takes_edits {
            let why = "this editor lets nobody else change a text that it has open: change it there";
            return done(Err(why.into()));
        }
        if document.kept != Kept::Whole || **document.text.whole() != before {
            return done(Err(CHANGING.into()));
        }
        let (key, asked) = (self.key.clone(), self.asked.clone());
        if edits(&asked).insert(key.clone(), document.edited) == Some(document.edited) {
            return done(Err("the editor is changing the text: try it again".into()));
        }
        let edit = least(&document.text, after, view.session.encoding);
        let edit = workspace(BTreeMap::from([(key.clone(), vec![edit])]), view);
        let params = lsp::ApplyWorkspaceEditParams { label: Some(LABEL.into()), edit, metadata: None };
        let heard = move |answer| {
            let answer = taken(answer);
            if answer.is_err() {
                edits(&asked).remove(&key);
            }
            done(answer);
        };
        let ask = Ask::new(lsp::LspRequestMethod::WorkspaceApplyEdit, json!(params)).then(heard);
        // Whoever waits is told that nobody answers where the server has ended.
        let _ = self.told.send(Told::Asks(ask));
    }
}

impl Store for Buffer {
    fn read(&self) -> Result<String, String> {
        let view = lock(&self.newest).clone();
        match view.documents.get(&self.key) {
            Some(document) => Ok(document.text.whole().to_string()),
            None => self.saved.read(),
        }
    }

    fn replace(&self, before: &str, after: &str, done: Done) {
        let view = lock(&self.newest).clone();
        match view.documents.get(&self.key) {
            // Nothing would come of it, not even another version.
            _ if before == after => done(Ok(())),
            Some(document) => self.ask(&view, document, before, after, done),
            None => self.saved.replace(before, after, done),
        }
    }
}

/// Whether the editor has taken an edit, or why not.
fn taken(answer: Answer<serde_json::Value>) -> Result<(), String> {
    let refused = |why: &str| Err(format!("the editor does not take it: {why}"));
    match answer {
        Ok(answer) if answer["applied"] == true => Ok(()),
        Ok(answer) => refused(answer["failureReason"].as_str().unwrap_or("it does not say why")),
        Err(failure) => refused(&failure.message),
    }
}

/// One entry is put in or taken out at a time.
fn edits(asked: &Asked) -> std::sync::MutexGuard<'_, BTreeMap<Key, u64>> {
    asked.lock().unwrap_or_else(PoisonError::into_inner)
}

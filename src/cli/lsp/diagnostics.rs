//! What is said of documents, to the client.

use super::analyst::{Looked, Meaning};
use super::documents::{Kept, Key, MOST_TEXT, MOST_TEXTS};
use super::view::View;
use gen_lsp_types as lsp;
use rt_lang::diagnostic::{Code, Diagnostic, Severity};
use std::collections::{BTreeMap, BTreeSet};

/// The most that is told of one file: nobody reads more, and there may be as many as characters.
const MOST: usize = 1_000;

/// What is said of each file of an analysis: of the document itself, and of what it reads, also where it is nothing.
pub type Found = BTreeMap<Key, Said>;

/// What is said of a file.
#[derive(Debug)]
pub struct Said {
    /// When its text was edited of which it is said; none where it was read as it is saved.
    edited: Option<u64>,
    all: Vec<lsp::Diagnostic>,
    /// Which of it does not hold where another text imports this one, by their indices.
    alone: BTreeSet<usize>,
}

impl Said {
    /// Nothing yet.
    fn new(view: &View, key: &Key) -> Said {
        Said { edited: edited(view, key), all: vec![], alone: BTreeSet::new() }
    }
}

/// When a file was edited last, if it is open.
fn edited(view: &View, key: &Key) -> Option<u64> {
    view.documents.get(key).map(|document| document.edited)
}

/// What a look at a document says of each file, and which files it is made of. Where it panicked nothing is known: what
/// was said before is taken back, and this is said in its place.
pub fn looked(looked: Looked, key: &Key, view: &View) -> (BTreeSet<Key>, Found) {
    match looked {
        Ok(meaning) => (meaning.reads.clone(), found(meaning, key, view)),
        Err((failure, reads)) => {
            let message = format!(
                "{}\nhelp: report it with this text; nothing else is known of it until it, or what it imports, is edited",
                failure.message
            );
            let own = Said { all: vec![plain(message)], ..Said::new(view, key) };
            (reads, Found::from([(key.clone(), own)]))
        }
    }
}

/// What an analysis says of each file.
fn found(meaning: &Meaning, key: &Key, view: &View) -> Found {
    let mut own = Said::new(view, key);
    let unknown = match view.documents.get(key).map(|document| document.kept) {
        None | Some(Kept::Whole) => None,
        Some(Kept::TooLong) => Some(too_long(format!(
            "a document has at most {} MiB, this is longer\nhelp: where it was made shorter, close it and open it again",
            MOST_TEXT >> 20
        ))),
        Some(Kept::TooMuch) => Some(too_long(format!(
            "all open documents have at most {} MiB together\nhelp: close others, then close this and open it again",
            MOST_TEXTS >> 20
        ))),
        Some(Kept::Lost) => Some(plain(
            "the editor has told of an edit that makes no sense: close this document and open it again"
                .into(),
        )),
    };
    let is_known = unknown.is_none();
    own.all.extend(unknown);
    let mut found = Found::from([(key.clone(), own)]);
    if !is_known {
        return found;
    }
    for file in &meaning.reads {
        found.entry(file.clone()).or_insert_with(|| Said::new(view, file));
    }
    let alone = meaning.analysis.alone();
    let mut more: BTreeMap<Key, usize> = BTreeMap::new();
    for (index, diagnostic) in meaning.analysis.diagnostics.iter().enumerate() {
        let file = meaning.key(diagnostic.primary.span.source);
        let said = found.entry(file.clone()).or_insert_with(|| Said::new(view, &file));
        if said.all.len() < MOST {
            said.alone.extend(alone.contains(&index).then_some(said.all.len()));
            said.all.push(convert(diagnostic, meaning, view));
        } else {
            *more.entry(file).or_default() += 1;
        }
    }
    for (file, count) in more {
        found.entry(file).and_modify(|said| said.all.push(further(count)));
    }
    found
}

/// Says that a document is not looked at.
fn too_long(message: String) -> lsp::Diagnostic {
    lsp::Diagnostic { code: Some(lsp::Code::String(Code::E0406.as_str().into())), ..plain(message) }
}

/// Says of a document what is not about the language.
fn plain(message: String) -> lsp::Diagnostic {
    lsp::Diagnostic {
        severity: Some(lsp::DiagnosticSeverity::Error),
        source: Some("rtc".into()),
        message: lsp::Message::String(message),
        ..lsp::Diagnostic::default()
    }
}

/// Says that there is more.
fn further(count: usize) -> lsp::Diagnostic {
    lsp::Diagnostic {
        severity: Some(lsp::DiagnosticSeverity::Information),
        source: Some("rtc".into()),
        message: lsp::Message::String(format!("{count} more are not shown: `rtc check` has all")),
        ..lsp::Diagnostic::default()
    }
}

/// One, as the client has it.
pub fn convert(diagnostic: &Diagnostic, meaning: &Meaning, view: &View) -> lsp::Diagnostic {
    let Diagnostic { code, primary, labels, uses, .. } = diagnostic;
    let related = |span, message: String| lsp::DiagnosticRelatedInformation {
        location: meaning.location(span, view),
        message,
    };
    let labels = labels.iter().map(|label| related(label.span, label.text.clone()));
    let uses = uses.iter().map(|used| {
        let head = meaning.analysis.sources.head(used.span);
        let turn = used.turn.as_ref().map_or_else(String::new, |turn| format!(", {turn}"));
        related(used.span, format!("in `{head}`{turn}"))
    });
    lsp::Diagnostic {
        range: meaning.range(primary.span),
        severity: Some(match diagnostic.severity() {
            Severity::Error => lsp::DiagnosticSeverity::Error,
            Severity::Warning => lsp::DiagnosticSeverity::Warning,
        }),
        code: Some(lsp::Code::String(code.as_str().into())),
        code_description: view.session.pages.address(*code).map(|href| lsp::CodeDescription { href }),
        source: Some("rtc".into()),
        message: lsp::Message::String(words(diagnostic)),
        tags: matches!(code, Code::W0105 | Code::W0106).then(|| vec![lsp::DiagnosticTag::Unnecessary]),
        related_information: Some(labels.chain(uses).collect::<Vec<_>>()).filter(|all| !all.is_empty()),
        data: None,
    }
}

/// The message, what is said of the place, and the help, each on a line.
fn words(diagnostic: &Diagnostic) -> String {
    let mut words = diagnostic.message.clone();
    // Said once is enough.
    if !diagnostic.message.contains(&*diagnostic.primary.text) {
        words.push_str(&format!(": {}", diagnostic.primary.text));
    }
    if let Some(help) = &diagnostic.help {
        words.push_str(&format!("\nhelp: {help}"));
    }
    words
}

/// What was found around each document, and what the client was told of each file.
#[derive(Debug, Default)]
pub struct Board {
    by_document: BTreeMap<Key, Found>,
    told: BTreeMap<Key, lsp::PublishDiagnosticsParams>,
}

impl Board {
    /// Takes what was found around a document in place of what was found before, and gives what is to be told.
    pub fn take(&mut self, document: Key, found: Found, view: &View) -> Vec<lsp::PublishDiagnosticsParams> {
        let before = self.by_document.get(&document).into_iter().flat_map(BTreeMap::keys);
        let files: BTreeSet<Key> = before.chain(found.keys()).cloned().collect();
        self.by_document.insert(document, found);
        files.into_iter().flat_map(|file| self.news(file, view)).collect()
    }

    /// Forgets a document that was closed.
    pub fn close(&mut self, document: &Key, view: &View) -> Vec<lsp::PublishDiagnosticsParams> {
        let found = self.by_document.remove(document).unwrap_or_default();
        found.into_keys().flat_map(|file| self.news(file, view)).collect()
    }

    /// All that is said of a file as it is now: by its own analysis first, since what others say of it is mostly the same. None
    /// where it is open and was not looked at as it is now.
    fn all(&self, file: &Key, view: &View) -> Option<Vec<lsp::Diagnostic>> {
        let edited = edited(view, file);
        let is_current = |found: &&Found| found.get(file).is_some_and(|said| said.edited == edited);
        if edited.is_some() && !self.by_document.get(file).is_some_and(|found| is_current(&found)) {
            return None;
        }
        let own = self.by_document.get(file).into_iter();
        let others = || self.by_document.iter().filter(|(key, _)| *key != file).map(|(_, found)| found);
        let is_imported = others().any(|found| found.contains_key(file));
        let said = own.chain(others()).filter(is_current).filter_map(|found| found.get(file));
        let holds = |said: &Said, index: usize| !is_imported || !said.alone.contains(&index);
        let said = said.flat_map(|said| {
            let all = said.all.iter().enumerate();
            all.filter(move |(index, _)| holds(said, *index)).map(|(_, diagnostic)| diagnostic)
        });
        let mut seen = BTreeSet::new();
        let place = |range: lsp::Range| {
            [range.start.line, range.start.character, range.end.line, range.end.character]
        };
        let is_new = |diagnostic: &&lsp::Diagnostic| {
            seen.insert((place(diagnostic.range), format!("{:?}", diagnostic.message)))
        };
        Some(said.filter(is_new).cloned().collect())
    }

    /// What is to be told of a file, if that is not what was told. A client may tell files apart by their addresses as they are
    /// written: what was told under one is taken back under that one.
    fn news(&mut self, file: Key, view: &View) -> Vec<lsp::PublishDiagnosticsParams> {
        let Some(diagnostics) = self.all(&file, view) else { return vec![] };
        let document = view.documents.get(&file);
        let version = document.map(|document| document.version);
        let before = self.told.remove(&file);
        let uri = match (document, &before) {
            (Some(document), _) => document.uri.clone(),
            (None, Some(before)) => before.uri.clone(),
            (None, None) => file.uri(),
        };
        let now = lsp::PublishDiagnosticsParams { uri, version, diagnostics };
        if version.is_some() || !now.diagnostics.is_empty() {
            self.told.insert(file, now.clone());
        }
        let nothing = |at: &lsp::PublishDiagnosticsParams| lsp::PublishDiagnosticsParams {
            uri: at.uri.clone(),
            version: None,
            diagnostics: vec![],
        };
        let before = before.unwrap_or_else(|| nothing(&now));
        let elsewhere = (before.uri != now.uri && !before.diagnostics.is_empty()).then(|| nothing(&before));
        elsewhere.into_iter().chain((before != now).then_some(now)).collect()
    }
}

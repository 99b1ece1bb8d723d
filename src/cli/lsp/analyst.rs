//! What documents mean, found out once for each of their states.

use super::document::{Encoding, Place, Text};
use super::documents::{Document, Key};
use super::view::View;
use super::work::{Failure, guarded};
use super::world::{Names, World};
use gen_lsp_types::{Location, Position, Range, Uri};
use rt_lang::analyse;
use rt_lang::files::FilePath;
use rt_lang::ide::{self, Analysis, Stop};
use rt_lang::span::{SourceId, Span};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, OnceLock};

/// What a document meant at some moment.
#[derive(Debug)]
pub struct Meaning {
    /// What it is all about.
    pub analysis: Analysis,
    /// The files that were asked for.
    pub reads: BTreeSet<Key>,
    /// When those of them were edited last that were open.
    edited: BTreeMap<Key, u64>,
    names: Names,
    /// The texts with their lines, as far as they were wanted.
    texts: Vec<OnceLock<Text>>,
    encoding: Encoding,
}

impl Meaning {
    /// Finds out what a document means, or a file that is not open. None where it is not wanted any more or cannot be read.
    pub fn find(view: &View, key: &Key, stop: Stop) -> Option<Meaning> {
        Meaning::find_in(&World::around(view, key), view, key, stop)
    }

    fn find_in(world: &World, view: &View, key: &Key, stop: Stop) -> Option<Meaning> {
        let source = world.source().ok()?;
        let analysis = analyse(world, source, &view.session.options(), stop)?;
        let texts: Vec<OnceLock<Text>> = (0..analysis.sources.len()).map(|_| OnceLock::new()).collect();
        if let (Some(document), Some(text)) = (view.documents.get(key), texts.get(analysis.main.0 as usize)) {
            // Its lines are known already.
            let _ = text.set(document.text.clone());
        }
        let (names, reads) = (world.names(), world.asked());
        let edited = edits(view, &reads).map(|(key, edited)| (key.clone(), edited)).collect();
        Some(Meaning { analysis, reads, edited, names, texts, encoding: view.session.encoding })
    }

    /// Whether it was found in what is open, as far as it is made of that: which version of a text an edit is of is told by
    /// what is open.
    fn is_of(&self, view: &View) -> bool {
        edits(view, &self.reads).eq(self.edited.iter().map(|(key, edited)| (key, *edited)))
    }

    /// The text of a source, with its lines.
    pub fn text(&self, id: SourceId) -> &Text {
        self.texts[id.0 as usize].get_or_init(|| Text::new(self.analysis.sources.get(id).text.clone()))
    }

    /// The byte of the document at a position.
    pub fn byte(&self, position: Position) -> usize {
        self.text(self.analysis.main).byte(super::documents::place(position), self.encoding)
    }

    /// The bytes of the document in a range.
    pub fn bytes(&self, range: Range) -> std::ops::Range<usize> {
        let (start, end) = (self.byte(range.start), self.byte(range.end));
        start..end.max(start)
    }

    /// The position of a byte of the document.
    pub fn position(&self, byte: usize) -> Position {
        position(self.text(self.analysis.main), byte, self.encoding)
    }

    /// The range of a span of any of the texts.
    pub fn range(&self, span: Span) -> Range {
        range(self.text(span.source), span.range(), self.encoding)
    }

    /// The range of bytes of the document.
    pub fn own_range(&self, bytes: std::ops::Range<usize>) -> Range {
        range(self.text(self.analysis.main), bytes, self.encoding)
    }

    /// The file of a source.
    pub fn key(&self, id: SourceId) -> Key {
        self.names.key(&self.analysis.sources.get(id).path)
    }

    /// The file of a path.
    pub fn key_at(&self, path: &FilePath) -> Key {
        self.names.key(path)
    }

    /// Where a span is, for the client.
    pub fn location(&self, span: Span, view: &View) -> Location {
        Location { uri: uri(view, &self.key(span.source)), range: self.range(span) }
    }

    /// Where bytes of a file of this analysis are; none where it is not made of that file.
    pub fn place(&self, place: &ide::Location) -> Option<(Key, Range)> {
        let (id, _) = self.analysis.source_at(&place.path)?;
        Some((self.key(id), range(self.text(id), place.range.clone(), self.encoding)))
    }
}

/// When those of some files were edited last that are open, in their order.
fn edits<'f>(view: &View, files: &'f BTreeSet<Key>) -> impl Iterator<Item = (&'f Key, u64)> {
    files.iter().filter_map(|key| Some((key, view.documents.get(key)?.edited)))
}

/// The position of a byte.
pub fn position(text: &Text, byte: usize, encoding: Encoding) -> Position {
    let Place { line, character } = text.place(byte, encoding);
    Position { line, character }
}

/// The range of some bytes.
pub fn range(text: &Text, bytes: std::ops::Range<usize>, encoding: Encoding) -> Range {
    Range { start: position(text, bytes.start, encoding), end: position(text, bytes.end, encoding) }
}

/// The address of a file: as the client writes it, where it has it open.
pub fn uri(view: &View, key: &Key) -> Uri {
    view.documents.get(key).map_or_else(|| key.uri(), |document| document.uri.clone())
}

/// What a look at a document found: what it means, or why that is not known, with the files that were asked for.
pub type Looked<'a> = Result<&'a Arc<Meaning>, (&'a Failure, BTreeSet<Key>)>;

/// Keeps what the open documents mean.
#[derive(Debug, Default)]
pub struct Analyst {
    known: BTreeMap<Key, (u64, Arc<Meaning>)>,
}

impl Analyst {
    /// What an open document means in the state in which it is seen. None where `stop` said so. `told` hears of what was not
    /// known before.
    ///
    /// # Errors
    ///
    /// Where finding it out panics.
    pub fn meaning(
        &mut self,
        view: &View,
        key: &Key,
        document: &Document,
        stop: Stop,
        told: impl FnOnce(Looked),
    ) -> Result<Option<Arc<Meaning>>, Failure> {
        if let Some((stamp, meaning)) = self.known.get(key)
            && *stamp == document.stamp
            // That it reads what has changed since may not be known yet.
            && meaning.is_of(view)
        {
            return Ok(Some(meaning.clone()));
        }
        let world = World::around(view, key);
        let meaning = match guarded(|| Meaning::find_in(&world, view, key, stop)) {
            Ok(Some(meaning)) => Arc::new(meaning),
            Ok(None) => return Ok(None),
            Err(failure) => {
                told(Err((&failure, world.asked())));
                return Err(failure);
            }
        };
        // It takes a while to take apart, which nobody should wait for.
        let _before = self.known.insert(key.clone(), (document.stamp, meaning.clone()));
        told(Ok(&meaning));
        Ok(Some(meaning))
    }

    /// Forgets what is closed.
    pub fn keep(&mut self, view: &View) {
        self.known.retain(|key, _| view.documents.get(key).is_some());
    }
}

#[cfg(test)]
mod tests {
    use super::super::client::Client;
    use super::super::diagnostics::{self, Board};
    use super::super::documents::Documents;
    use super::super::pages::Pages;
    use super::super::view::Session;
    use super::*;
    use serde_json::json;

    /// One that knows of these documents.
    fn view(documents: Documents) -> View {
        let session = Session {
            client: Client::default(),
            encoding: Encoding::Utf16,
            root: None,
            pages: Pages::default(),
            memory: Arc::default(),
        };
        View { session: Arc::new(session), documents, folders: vec![] }
    }

    #[test]
    fn behind_a_panic_nothing_old_is_shown_and_what_was_read_is_known() {
        let mut documents = Documents::default();
        let read = documents.open("file:///nowhere/b.rt".to_string().into(), 1, "let a = 1m\n".into());
        let text = "import \"b.rt\" as b\nsphere {}\n";
        let own = documents.open("file:///nowhere/a.rt".to_string().into(), 1, text.into());
        let view = view(documents);
        let (mut analyst, mut board) = (Analyst::default(), Board::default());
        let mut look = |analyst: &mut Analyst, stop: Stop| {
            let document = view.documents.get(&own).unwrap().clone();
            let (mut told, mut reads) = (vec![], BTreeSet::new());
            let hear = |looked: Looked| {
                let found;
                (reads, found) = diagnostics::looked(looked, &own, &view);
                told = board.take(own.clone(), found, &view);
            };
            let answer = analyst.meaning(&view, &own, &document, stop, hear);
            let said: Vec<String> = told
                .iter()
                .flat_map(|told| &told.diagnostics)
                .map(|said| format!("{:?}", said.message))
                .collect();
            (answer.is_ok(), reads, said)
        };
        let (is_known, reads, said) = look(&mut analyst, &|| false);
        assert!(
            is_known && reads.contains(&read) && said.iter().any(|said| said.contains("radius")),
            "{said:?}"
        );
        // As if the text were another now.
        analyst.known.clear();
        let (is_known, reads, said) = look(&mut analyst, &|| panic!("oh"));
        assert!(!is_known && reads.contains(&read), "{reads:?}");
        assert!(matches!(&said[..], [said] if said.contains("bug in rtc: oh")), "{said:?}");
    }

    #[test]
    fn what_was_found_in_another_version_of_what_is_read_is_found_anew() {
        let mut documents = Documents::default();
        let uri = "file:///nowhere/b.rt";
        let read = documents.open(uri.to_string().into(), 1, "let seat = 1m\n".into());
        let text = "import \"b.rt\" as b\nsphere { radius: b.seat }\n";
        let own = documents.open("file:///nowhere/a.rt".to_string().into(), 1, text.into());
        let mut view = view(documents);
        let mut analyst = Analyst::default();
        let mut look = |view: &View| {
            let document = view.documents.get(&own).unwrap().clone();
            let mut is_new = false;
            let meaning = analyst.meaning(view, &own, &document, &|| false, |_| is_new = true);
            let meaning = meaning.unwrap().unwrap();
            let texts: Vec<String> =
                meaning.analysis.sources.iter().map(|(_, source)| source.text.clone()).collect();
            (is_new, texts.concat())
        };
        let (is_new, texts) = look(&view);
        assert!(is_new && texts.contains("seat = 1m"), "{texts}");
        assert!(!look(&view).0);
        // Nobody has said that the one reads the other.
        let changes = json!([{ "text": "let seat = 2m\n" }]);
        let changed = json!({ "textDocument": { "uri": uri, "version": 2 }, "contentChanges": changes });
        view.documents.change(&read, serde_json::from_value(changed).unwrap(), Encoding::Utf16);
        let (is_new, texts) = look(&view);
        assert!(is_new && texts.contains("seat = 2m"), "{texts}");
        view.documents.close(&read);
        assert!(look(&view).0);
    }
}

//! What an editor asks of a scene: plain questions with plain answers, as bytes of texts. It knows no protocol.
//!
//! An [`Analysis`] is what one text means together with all it imports, and never changes: an edit makes another one, by
//! [`crate::analyse`], which runs the stages that [`crate::compile`] runs. Most questions are about the text that was analysed; what they
//! point at may lie in another file. Questions that are asked while a statement is being typed, [`complete()`] and
//! [`signatures`], take the text itself, and so does [`outline`], which needs no analysis. [`references`] and [`rename()`] look through several analyses, since who
//! uses a file is not known in it.
//!
//! No text, offset or range makes a question panic: what lies outside a text is moved to its end.

mod alone;
mod answers;
mod colours;
mod complete;
mod cursor;
mod definition;
mod fixes;
mod folds;
mod hints;
mod hover;
mod layout;
mod lenses;
mod lex;
mod links;
mod named;
mod optics;
mod rename;
mod say;
mod selection;
mod signature;
mod symbols;
mod tokens;
mod typing;
mod walk;
mod wanted;

pub use answers::*;
pub use complete::complete;
pub use layout::{differences, differences_within};
pub use rename::{references, rename};
pub use say::{default, hex, range};
pub use signature::signatures;
pub use symbols::outline;

use crate::check::Notes;
use crate::diagnostic::{Diagnostic, any_errors};
use crate::eval::Values;
use crate::files::FilePath;
use crate::import::ImportedFile;
use crate::scene::Camera;
use crate::source::{Source, Sources};
use crate::span::{SourceId, Span};
use std::collections::BTreeSet;
use std::ops::Range;

/// Asked between steps whether the answer is still wanted: `true` ends the work.
pub type Stop<'s> = &'s (dyn Fn() -> bool + Sync);

/// What one text means together with all it imports. It can be shared among threads.
#[derive(Debug)]
pub struct Analysis {
    /// All texts: the one that was analysed, those it imports, and settings.
    pub sources: Sources,
    /// The one that was analysed.
    pub main: SourceId,
    /// Errors and warnings in all of them, by place.
    pub diagnostics: Vec<Diagnostic>,
    /// One line for each default that was chosen for the user.
    pub notes: Vec<String>,
    study: Study,
}

/// What the stages learn of a text on their way.
#[derive(Debug, Default)]
pub struct Study {
    /// The trees of all files.
    pub files: Vec<ImportedFile>,
    /// What names mean.
    pub notes: Notes,
    /// What expressions come to.
    pub values: Values,
    /// What is seen through the cameras that somebody wrote, and where their blocks stand.
    pub views: Vec<(Camera, Span)>,
    /// The names of those that have one, in the order written.
    pub cameras: Vec<String>,
}

impl Analysis {
    /// Puts together what the stages found out.
    pub(crate) fn new(
        sources: Sources,
        main: SourceId,
        diagnostics: Vec<Diagnostic>,
        notes: Vec<String>,
        study: Study,
    ) -> Analysis {
        Analysis { sources, main, diagnostics, notes, study }
    }

    /// The text that was analysed.
    pub fn source(&self) -> &Source {
        self.sources.get(self.main)
    }

    /// The text of a file, if the scene is made of it.
    pub fn source_at(&self, path: &FilePath) -> Option<(SourceId, &Source)> {
        self.files().find(|(_, source)| source.path == *path)
    }

    /// The files of the scene that are texts of the language, the one that was analysed among them.
    pub fn files(&self) -> impl Iterator<Item = (SourceId, &Source)> {
        self.study.files.iter().map(|file| (file.source, self.sources.get(file.source)))
    }

    /// What can be said of what stands at a byte: its type, its value, the words above its declaration.
    pub fn hover(&self, at: usize) -> Option<Hover> {
        hover::hover(self, at)
    }

    /// Where what is named at a byte is declared. What is built in is declared nowhere.
    pub fn definition(&self, at: usize) -> Option<Definition> {
        definition::definition(self, at)
    }

    /// The name that declares what is named at a byte, which is what [`references`] and [`rename()`] look for. None of what is
    /// built in.
    pub fn declaration(&self, at: usize) -> Option<Span> {
        definition::declaration(self, at).map(|(_, name)| name)
    }

    /// The name at a byte, if it can be renamed; else a sentence that says why not. None where no name stands.
    pub fn renamable(&self, at: usize) -> Option<Result<Span, String>> {
        rename::renamable(self, at)
    }

    /// The names of the cameras that pictures can be taken with. None where there are errors, which may have hidden some.
    pub fn cameras(&self) -> Option<&[String]> {
        (!any_errors(&self.diagnostics)).then_some(&*self.study.cameras)
    }

    /// Which of the diagnostics are said of the text as a scene of its own, and do not hold where another one imports it: that
    /// nothing stands in it, and that nothing uses what it declares.
    pub fn alone(&self) -> BTreeSet<usize> {
        alone::alone(self)
    }

    /// What the text declares, as a tree.
    pub fn symbols(&self) -> Vec<Symbol> {
        symbols::symbols(self)
    }

    /// The bodies and comments of more than one line.
    pub fn folds(&self) -> Vec<Fold> {
        folds::folds(self)
    }

    /// The ranges around a byte that are units of the language, innermost first.
    pub fn selection(&self, at: usize) -> Vec<Span> {
        selection::selection(self, at)
    }

    /// What the words of a part of the text are, in order. None overlaps another, or goes over a line end. Once `stop` says so,
    /// the rest is left out.
    pub fn tokens(&self, range: Range<usize>, stop: Stop) -> Vec<Token> {
        tokens::tokens(self, range, stop)
    }

    /// The colours that are written in the text; only some once `stop` says so.
    pub fn colours(&self, stop: Stop) -> Vec<Colour> {
        colours::colours(self, stop)
    }

    /// The ways to write a colour in place of the one in a part of the text, each to replace all of it: in its own form
    /// first. Red, green and blue are display-referred, from 0 to 1.
    pub fn present(&self, range: Range<usize>, value: [f64; 3]) -> Vec<String> {
        colours::present(self, range, value)
    }

    /// What a part of the text does not say and is known all the same: what expressions come to, what follows from a lens.
    /// Only some of it once `stop` says so.
    pub fn hints(&self, range: Range<usize>, stop: Stop) -> Vec<Hint> {
        hints::hints(self, range, stop)
    }

    /// The edits that lay out a part of the text as the formatter does; none where it has an error.
    pub fn format(&self, range: Range<usize>) -> Vec<Edit> {
        layout::format(self, range)
    }

    /// The files that the text names, each as a path.
    pub fn links(&self) -> Vec<Link> {
        links::links(self)
    }

    /// Where something can be done with the picture: shown, or made.
    pub fn lenses(&self) -> Vec<Lens> {
        lenses::lenses(self)
    }

    /// What can be mended in a part of the text without a thought, and warnings that can be allowed.
    pub fn fixes(&self, range: Range<usize>) -> Vec<Fix> {
        fixes::fixes(self, range)
    }
}

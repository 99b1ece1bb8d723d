//! The answers: plain data.

use crate::files::FilePath;
use crate::span::Span;
use std::cmp::Ordering;
use std::ops::Range;

/// Bytes of a file of some analysis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// The file.
    pub path: FilePath,
    /// Its bytes.
    pub range: Range<usize>,
}

impl Ord for Location {
    /// By file and place.
    fn cmp(&self, other: &Location) -> Ordering {
        let key = |location: &Location| (location.range.start, location.range.end);
        self.path.cmp(&other.path).then_with(|| key(self).cmp(&key(other)))
    }
}

impl PartialOrd for Location {
    fn partial_cmp(&self, other: &Location) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Bytes of a file, and what stands there afterwards.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Edit {
    /// What is replaced; empty where text is put in.
    pub at: Location,
    /// By what.
    pub text: String,
}

/// What is said of what stands at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Hover {
    /// What it is about.
    pub span: Span,
    /// What it is, in the language: `param count: int = 7 in 1 to 20`.
    pub code: String,
    /// What it comes to, as the language writes it, where that is not what is written: `35mm`. Inside a loop or a part, the
    /// first time.
    pub value: Option<String>,
    /// Words about it, as Markdown; may be empty.
    pub doc: String,
    /// The colour it is, display-referred: red, green and blue from 0 to 1. What is brighter than white is shown darker, in
    /// its hue.
    pub colour: Option<[f64; 3]>,
}

/// Where something is declared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Definition {
    /// What was asked about, in the text that was analysed.
    pub from: Span,
    /// The name where it is declared; the beginning of the file, where that is what is named.
    pub name: Span,
    /// All of the declaration.
    pub whole: Span,
}

/// Something that can stand where the cursor is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Completion {
    /// What is shown, and compared with what was typed.
    pub label: String,
    /// What it is.
    pub kind: CompletionKind,
    /// The bytes of the text that it replaces: the word at the cursor.
    pub replace: Range<usize>,
    /// What is put there.
    pub insert: Insert,
    /// Its type or default, in a few words; may be empty.
    pub detail: String,
    /// Words about it, as Markdown; may be empty.
    pub doc: String,
    /// Those that fit better come first: lower is better. The order of the list is by rank, then by label.
    pub rank: u32,
}

/// Text with places to be filled in.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Insert {
    /// The text. Its later lines are to be indented as the line that it is put in.
    pub text: String,
    /// The ranges of it that are gone through one after the other, in order; what they hold is an example. Behind the
    /// last one the cursor stays; without any, at the end of the text.
    pub holes: Vec<Range<usize>>,
}

/// What a completion is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CompletionKind {
    /// A word of the language.
    Keyword,
    /// A kind of thing.
    Kind,
    /// A prototype or part, used as a kind.
    Prototype,
    /// A field, or a param where its part is used.
    Field,
    /// The name of a value.
    Value,
    /// A name of a material.
    Material,
    /// A thing of the scene.
    Thing,
    /// A colour.
    Colour,
    /// A function.
    Function,
    /// A word that a field understands.
    Word,
    /// A unit.
    Unit,
    /// A type.
    Type,
    /// An imported file.
    Module,
    /// A file.
    File,
    /// A folder.
    Folder,
    /// A code of a warning.
    Code,
}

/// How something is called, or made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signature {
    /// As it is written: `linspace(a, b, count)`.
    pub label: String,
    /// Words about it, as Markdown; may be empty.
    pub doc: String,
    /// What it takes, in order.
    pub parameters: Vec<Parameter>,
    /// Which of these the cursor is at; none where it takes no more.
    pub active: Option<usize>,
}

/// One of what is taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// Bytes of the label.
    pub range: Range<usize>,
    /// Words about it; may be empty.
    pub doc: String,
}

/// Something that a text declares.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// Its name; of a thing without one, its kind.
    pub name: String,
    /// What it is.
    pub kind: SymbolKind,
    /// In a few words; may be empty.
    pub detail: String,
    /// All of it.
    pub span: Span,
    /// The name.
    pub select: Span,
    /// What it holds.
    pub children: Vec<Symbol>,
    /// Whether it is left out of the picture: `@off`.
    pub off: bool,
}

/// What a symbol is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SymbolKind {
    /// A shape that is drawn.
    Shape,
    /// A group, or a use of a part.
    Group,
    /// A light.
    Light,
    /// A camera, its lens, or how the picture is made.
    Block,
    /// A material.
    Material,
    /// A prototype of a thing.
    Prototype,
    /// Any other named value.
    Value,
    /// A setting.
    Param,
    /// A part.
    Part,
    /// An imported file.
    Module,
    /// A function.
    Function,
}

/// Lines that can be hidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fold {
    /// From the first to the last.
    pub span: Span,
    /// What they are.
    pub kind: FoldKind,
}

/// What is folded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FoldKind {
    /// What stands between brackets.
    Body,
    /// A comment, or several below each other.
    Comment,
    /// Imports below each other.
    Imports,
}

/// A word, or another piece of text, and what it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token {
    /// Where it stands.
    pub span: Span,
    /// What it is.
    pub kind: TokenKind,
    /// Whether it is declared here.
    pub declaration: bool,
    /// Whether the language declares it.
    pub built_in: bool,
}

/// What a piece of text is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[allow(missing_docs)]
pub enum TokenKind {
    Comment,
    Doc,
    Keyword,
    Kind,
    Prototype,
    Part,
    Field,
    Value,
    Param,
    Variable,
    Material,
    Thing,
    Function,
    Module,
    Type,
    Word,
    Number,
    Unit,
    Text,
    Colour,
    Operator,
    Prefix,
}

impl TokenKind {
    /// Every kind, in order.
    pub const ALL: &'static [TokenKind] = {
        use TokenKind::*;
        &[
            Comment, Doc, Keyword, Kind, Prototype, Part, Field, Value, Param, Variable, Material, Thing,
            Function, Module, Type, Word, Number, Unit, Text, Colour, Operator, Prefix,
        ]
    };
}

/// A colour that is written in a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour {
    /// Where.
    pub span: Span,
    /// Display-referred: red, green and blue from 0 to 1. What is brighter than white is shown darker, in its hue.
    pub value: [f64; 3],
}

/// A remark between the characters of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hint {
    /// Before this byte.
    pub at: usize,
    /// What is shown: ` = 35mm`.
    pub text: String,
    /// What it means, in a sentence; may be empty.
    pub about: String,
}

/// The name of a file in a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Link {
    /// Between the quotes.
    pub span: Span,
    /// The file.
    pub path: FilePath,
}

/// A place where something can be done with the picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lens {
    /// The line it belongs to begins here.
    pub span: Span,
    /// What can be done.
    pub action: LensAction,
    /// With which camera, where it has a name.
    pub camera: Option<String>,
}

/// What can be done with a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LensAction {
    /// Show it while it is edited.
    Preview,
    /// Make the file.
    Render,
}

/// A mend of a slip, or words that silence a warning.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    /// What it does, as an imperative sentence.
    pub title: String,
    /// Which of [`super::Analysis::diagnostics`] it ends.
    pub diagnostic: usize,
    /// The edits, which do not overlap.
    pub edits: Vec<Edit>,
    /// Whether it is the one mend of the slip; else it is to be chosen from several, or silences a warning.
    pub mends: bool,
}

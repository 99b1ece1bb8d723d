//! What the words of a text are, as numbers.

use super::super::analyst::Meaning;
use super::super::work::{Answer, Asked};
use gen_lsp_types as lsp;
use rt_lang::ide::{Token, TokenKind};

/// The names of the types and modifiers that the numbers stand for. Types have the names that colour themes know.
pub fn legend() -> lsp::SemanticTokensLegend {
    lsp::SemanticTokensLegend {
        token_types: TokenKind::ALL.iter().map(|&kind| name(kind).into()).collect(),
        token_modifiers: ["declaration", "defaultLibrary", "documentation", "readonly"]
            .map(String::from)
            .into(),
    }
}

const DECLARATION: u32 = 1;
const BUILT_IN: u32 = 1 << 1;
const DOCUMENTATION: u32 = 1 << 2;
const READ_ONLY: u32 = 1 << 3;

fn name(kind: TokenKind) -> &'static str {
    match kind {
        TokenKind::Comment | TokenKind::Doc => "comment",
        TokenKind::Keyword => "keyword",
        TokenKind::Kind => "class",
        TokenKind::Prototype | TokenKind::Part => "struct",
        TokenKind::Field => "property",
        TokenKind::Value | TokenKind::Variable | TokenKind::Material | TokenKind::Thing => "variable",
        TokenKind::Param => "parameter",
        TokenKind::Function => "function",
        TokenKind::Module => "namespace",
        TokenKind::Type => "type",
        TokenKind::Word => "enumMember",
        TokenKind::Number | TokenKind::Colour => "number",
        TokenKind::Unit => "keyword",
        TokenKind::Text => "string",
        TokenKind::Operator => "operator",
        TokenKind::Prefix => "decorator",
    }
}

/// The words of a document.
pub fn full(asked: &mut Asked, params: lsp::SemanticTokensParams) -> Answer<Option<lsp::SemanticTokens>> {
    words(asked, &params.text_document.uri, None)
}

/// The words of a part of it.
pub fn part(
    asked: &mut Asked,
    params: lsp::SemanticTokensRangeParams,
) -> Answer<Option<lsp::SemanticTokens>> {
    words(asked, &params.text_document.uri, Some(params.range))
}

fn words(asked: &mut Asked, uri: &lsp::Uri, part: Option<lsp::Range>) -> Answer<Option<lsp::SemanticTokens>> {
    let (document, meaning) = (asked.document(uri)?, asked.meaning(uri)?);
    let range = part.map_or(0..meaning.analysis.source().text.len(), |part| meaning.bytes(part));
    let tokens = meaning.analysis.tokens(range, &|| asked.spoilt(&document).is_some());
    asked.spoilt(&document).map_or_else(|| Ok(Some(numbers(&meaning, &tokens))), Err)
}

/// Each as lines and units from the one before.
fn numbers(meaning: &Meaning, tokens: &[Token]) -> lsp::SemanticTokens {
    let (mut line, mut start) = (0, 0);
    let mut data = Vec::with_capacity(tokens.len());
    for token in tokens {
        let range = meaning.range(token.span);
        // The protocol has no token without length, or over a line end.
        if range.start.line != range.end.line || range.start == range.end {
            continue;
        }
        let same_line = range.start.line == line;
        data.push(lsp::SemanticToken {
            delta_line: range.start.line - line,
            delta_start: if same_line { range.start.character - start } else { range.start.character },
            length: range.end.character - range.start.character,
            token_type: TokenKind::ALL.iter().position(|kind| *kind == token.kind).unwrap_or(0) as u32,
            token_modifiers_bitset: modifiers(token),
        });
        (line, start) = (range.start.line, range.start.character);
    }
    lsp::SemanticTokens { result_id: None, data }
}

fn modifiers(token: &Token) -> u32 {
    let set = |is: bool, bit: u32| if is { bit } else { 0 };
    let constant = matches!(token.kind, TokenKind::Value | TokenKind::Material | TokenKind::Thing);
    set(token.declaration, DECLARATION)
        | set(token.built_in, BUILT_IN)
        | set(token.kind == TokenKind::Doc, DOCUMENTATION)
        | set(constant, READ_ONLY)
}

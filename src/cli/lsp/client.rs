//! What the client can do, as far as it makes a difference.
//!
//! It is read field by field from what the client says of itself: a field that is not understood makes no difference to
//! the others.

use super::document::Encoding;
use serde_json::Value;

/// What the client can do.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Client {
    /// Takes completions with places to be filled in.
    pub snippets: bool,
    /// Takes edits of several documents with the versions they are of.
    pub document_changes: bool,
    /// Lets its texts be edited, each in a certain version.
    pub takes_edits: bool,
    /// Takes symbols as a tree.
    pub symbol_tree: bool,
    /// Shows pictures in hovers.
    pub pictures: bool,
    /// Understands Markdown in hovers.
    pub markdown: bool,
    /// Understands Markdown in what is said of completions.
    pub markdown_docs: bool,
    /// Understands Markdown in what is said of calls.
    pub markdown_calls: bool,
    /// Takes it that no parameter of a call is the one being written.
    pub marks_none: bool,
    /// Takes mends as edits, and not only as commands.
    pub mends: bool,
    /// Asks whether something can be renamed.
    pub prepares: bool,
    /// Tells of files that change, if asked to.
    pub watches: bool,
    /// Shows how far something is.
    pub progress: bool,
    /// Shows documents.
    pub shows: bool,
    /// Takes links as origin and target.
    pub links: bool,
    /// Folds whole lines only.
    pub folds_lines: bool,
    /// Asks again for hints when told to.
    pub refreshes_hints: bool,
    /// Asks again for tokens when told to.
    pub refreshes_tokens: bool,
}

impl Client {
    /// What `initialize` says.
    pub fn read(params: &Value) -> Client {
        let at = |path: &str| params.pointer(&format!("/capabilities/{path}"));
        let can = |path: &str| at(path).and_then(Value::as_bool).unwrap_or(false);
        let has = |path: &str, word: &str| {
            at(path).and_then(Value::as_array).is_some_and(|all| all.iter().any(|one| one == word))
        };
        // Who makes and moves files takes changes with versions too: the protocol has them in one list.
        let document_changes = can("workspace/workspaceEdit/documentChanges")
            || at("workspace/workspaceEdit/resourceOperations").is_some_and(Value::is_array);
        Client {
            snippets: can("textDocument/completion/completionItem/snippetSupport"),
            document_changes,
            takes_edits: document_changes && can("workspace/applyEdit"),
            symbol_tree: can("textDocument/documentSymbol/hierarchicalDocumentSymbolSupport"),
            // The parser of Visual Studio Code and its kin, which draws pictures.
            pictures: at("general/markdown/parser").is_some_and(|parser| parser == "marked"),
            markdown: has("textDocument/hover/contentFormat", "markdown"),
            markdown_docs: has("textDocument/completion/completionItem/documentationFormat", "markdown"),
            markdown_calls: has(
                "textDocument/signatureHelp/signatureInformation/documentationFormat",
                "markdown",
            ),
            marks_none: can("textDocument/signatureHelp/signatureInformation/noActiveParameterSupport"),
            mends: at("textDocument/codeAction/codeActionLiteralSupport").is_some(),
            prepares: can("textDocument/rename/prepareSupport"),
            watches: can("workspace/didChangeWatchedFiles/dynamicRegistration"),
            progress: can("window/workDoneProgress"),
            shows: can("window/showDocument/support"),
            links: can("textDocument/definition/linkSupport"),
            folds_lines: can("textDocument/foldingRange/lineFoldingOnly"),
            refreshes_hints: can("workspace/inlayHint/refreshSupport"),
            refreshes_tokens: can("workspace/semanticTokens/refreshSupport"),
        }
    }
}

/// How characters are counted: in bytes where the client can, since texts are held so; in units of 16 bits where it says
/// nothing.
pub fn encoding(params: &Value) -> Encoding {
    let known = [("utf-8", Encoding::Utf8), ("utf-16", Encoding::Utf16), ("utf-32", Encoding::Utf32)];
    let offered = params.pointer("/capabilities/general/positionEncodings").and_then(Value::as_array);
    let offers = |name: &str| offered.is_some_and(|offered| offered.iter().any(|one| one == name));
    let chosen = known.into_iter().find(|(name, _)| offers(name));
    chosen.map_or(Encoding::Utf16, |(_, encoding)| encoding)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn what_is_not_understood_makes_no_difference() {
        for odd in
            [json!(null), json!([]), json!({"capabilities": 3}), json!({"capabilities": {"window": [1]}})]
        {
            assert_eq!((Client::read(&odd), encoding(&odd)), (Client::default(), Encoding::Utf16), "{odd}");
        }
        let some = json!({"capabilities": {
            "window": {"workDoneProgress": true, "showDocument": 7},
            "textDocument": {"hover": {"contentFormat": ["plaintext", "markdown", 4]}},
        }});
        assert_eq!(Client::read(&some), Client { progress: true, markdown: true, ..Client::default() });
    }

    #[test]
    fn edits_are_of_a_version_where_they_can_be() {
        for (edits, takes) in [
            (json!({ "applyEdit": true, "workspaceEdit": { "documentChanges": true } }), true),
            // As Neovim says it.
            (json!({ "applyEdit": true, "workspaceEdit": { "resourceOperations": ["create"] } }), true),
            (json!({ "applyEdit": true, "workspaceEdit": {} }), false),
            (json!({ "workspaceEdit": { "documentChanges": true } }), false),
        ] {
            let client = Client::read(&json!({ "capabilities": { "workspace": edits } }));
            assert_eq!(client.takes_edits, takes, "{edits}");
        }
    }

    #[test]
    fn bytes_are_counted_where_the_client_can() {
        let chosen =
            |offered: Value| encoding(&json!({"capabilities": {"general": {"positionEncodings": offered}}}));
        assert_eq!(chosen(json!(["utf-16", "utf-8"])), Encoding::Utf8);
        assert_eq!(chosen(json!(["utf-32", "utf-16"])), Encoding::Utf16);
        assert_eq!(chosen(json!(["utf-32"])), Encoding::Utf32);
        assert_eq!(chosen(json!(["klingon"])), Encoding::Utf16);
    }
}

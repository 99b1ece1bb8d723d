//! What the server can do.

use super::client::Client;
use super::commands;
use super::document::Encoding;
use super::requests::tokens::legend;
use gen_lsp_types as lsp;

/// Signs behind which something is offered without being asked for: of paths, values, fields of a thing, and prefixes.
const TRIGGERS: [&str; 6] = [".", ":", "\"", "/", "@", "#"];

/// What the server answers to `initialize`.
pub fn initialized(client: &Client, encoding: Encoding) -> lsp::InitializeResult {
    lsp::InitializeResult {
        capabilities: capabilities(client, encoding),
        server_info: Some(lsp::ServerInfo {
            name: "rtc".into(),
            version: Some(env!("CARGO_PKG_VERSION").into()),
        }),
    }
}

/// What the client is asked to watch: scenes, and what they read.
pub fn watched() -> lsp::RegistrationParams {
    let watch = |pattern: &str, kind| lsp::FileSystemWatcher {
        glob_pattern: lsp::GlobPattern::Pattern(pattern.into()),
        kind,
    };
    // Of a folder that comes or goes, some tell nothing but that.
    let [comes, goes] = [lsp::WatchKind::Create, lsp::WatchKind::Delete].map(u32::from);
    let watchers = vec![
        watch("**/*.{rt,csv,png,jpg,jpeg,webp,hdr,exr,pfm,ply,obj,stl}", None),
        watch("**", Some(lsp::WatchKind::Custom(comes | goes))),
    ];
    let options = lsp::DidChangeWatchedFilesRegistrationOptions { watchers };
    let registration = lsp::Registration {
        id: "watched-files".into(),
        method: lsp::LspNotificationMethod::WorkspaceDidChangeWatchedFiles.as_str().into(),
        register_options: serde_json::to_value(options).ok(),
    };
    lsp::RegistrationParams { registrations: vec![registration] }
}

fn capabilities(client: &Client, encoding: Encoding) -> lsp::ServerCapabilities {
    let words = |words: &[&str]| Some(words.iter().map(|word| word.to_string()).collect::<Vec<_>>());
    lsp::ServerCapabilities {
        position_encoding: Some(match encoding {
            Encoding::Utf8 => lsp::PositionEncodingKind::UTF8,
            Encoding::Utf16 => lsp::PositionEncodingKind::UTF16,
            Encoding::Utf32 => lsp::PositionEncodingKind::UTF32,
        }),
        text_document_sync: Some(lsp::TextDocumentSync::Options(lsp::TextDocumentSyncOptions {
            open_close: Some(true),
            change: Some(lsp::TextDocumentSyncKind::Incremental),
            save: Some(lsp::Save::Bool(true)),
            ..lsp::TextDocumentSyncOptions::default()
        })),
        completion_provider: Some(lsp::CompletionOptions {
            trigger_characters: words(&TRIGGERS),
            ..lsp::CompletionOptions::default()
        }),
        hover_provider: Some(lsp::HoverProvider::Bool(true)),
        signature_help_provider: Some(lsp::SignatureHelpOptions {
            trigger_characters: words(&["(", ",", "{"]),
            ..lsp::SignatureHelpOptions::default()
        }),
        definition_provider: Some(lsp::DefinitionProvider::Bool(true)),
        references_provider: Some(lsp::ReferencesProvider::Bool(true)),
        document_highlight_provider: Some(lsp::DocumentHighlightProvider::Bool(true)),
        document_symbol_provider: Some(lsp::DocumentSymbolProvider::Bool(true)),
        workspace_symbol_provider: Some(lsp::WorkspaceSymbolProvider::Bool(true)),
        code_action_provider: client.mends.then(|| {
            lsp::CodeActionProvider::CodeActionOptions(lsp::CodeActionOptions {
                code_action_kinds: Some(vec![
                    lsp::CodeActionKind::QuickFix,
                    lsp::CodeActionKind::SourceFixAll,
                ]),
                ..lsp::CodeActionOptions::default()
            })
        }),
        code_lens_provider: Some(lsp::CodeLensOptions::default()),
        document_link_provider: Some(lsp::DocumentLinkOptions::default()),
        color_provider: Some(lsp::ColorProvider::Bool(true)),
        document_formatting_provider: Some(lsp::DocumentFormattingProvider::Bool(true)),
        document_range_formatting_provider: Some(lsp::DocumentRangeFormattingProvider::Bool(true)),
        rename_provider: Some(match client.prepares {
            true => lsp::RenameProvider::RenameOptions(lsp::RenameOptions {
                prepare_provider: Some(true),
                ..lsp::RenameOptions::default()
            }),
            false => lsp::RenameProvider::Bool(true),
        }),
        folding_range_provider: Some(lsp::FoldingRangeProvider::Bool(true)),
        selection_range_provider: Some(lsp::SelectionRangeProvider::Bool(true)),
        execute_command_provider: Some(lsp::ExecuteCommandOptions {
            commands: commands::ALL.map(String::from).into(),
            ..lsp::ExecuteCommandOptions::default()
        }),
        semantic_tokens_provider: Some(lsp::SemanticTokensProvider::SemanticTokensOptions(
            lsp::SemanticTokensOptions {
                legend: legend(),
                range: Some(lsp::SemanticTokensOptionsRange::Bool(true)),
                full: Some(lsp::Full::Bool(true)),
                ..lsp::SemanticTokensOptions::default()
            },
        )),
        inlay_hint_provider: Some(lsp::InlayHintProvider::Bool(true)),
        workspace: Some(lsp::WorkspaceOptions {
            workspace_folders: Some(lsp::WorkspaceFoldersServerCapabilities {
                supported: Some(true),
                change_notifications: Some(lsp::ChangeNotifications::Bool(true)),
            }),
            ..lsp::WorkspaceOptions::default()
        }),
        ..lsp::ServerCapabilities::default()
    }
}

//! Trees and diagnostics as text for snapshots.

use rt_lang::diagnostic::{Diagnostic, Label};
use rt_lang::span::Span;
use rt_lang::syntax::ast::{
    Argument, Body, Construct, Entry, Expr, ExprKind, File, Name, Path, Statement, StatementKind, TypeName,
};
use std::fmt::Write;

/// A tree, one node a line, each with the text it covers.
pub fn tree(text: &str, file: &File) -> String {
    let mut dump = Dump { text, out: String::new(), indent: 0 };
    dump.body(&file.body);
    for comment in &file.comments {
        dump.line("comment", comment.span);
    }
    dump.out
}

/// A tree without its places: what must not change where a text is only laid out anew.
pub fn shape(text: &str, file: &File) -> String {
    let mut dump = Dump { text, out: String::new(), indent: 0 };
    dump.body(&file.body);
    // What a line covers begins with two spaces and the first «, which no name holds.
    dump.out
        .lines()
        .map(|line| line.split("  «").next().unwrap_or(""))
        .fold(String::new(), |all, line| all + line + "\n")
}

/// The tree of one expression.
pub fn expression(text: &str, expr: &Expr) -> String {
    let mut dump = Dump { text, out: String::new(), indent: 0 };
    dump.expr("", expr);
    dump.out
}

struct Dump<'t> {
    text: &'t str,
    out: String,
    indent: usize,
}

impl Dump<'_> {
    fn line(&mut self, what: &str, span: Span) {
        let covered = shorten(&self.text[span.range()]);
        // A tree of hundreds of levels would be all white space.
        let indent = "  ".repeat(self.indent.min(12));
        writeln!(self.out, "{indent}{what}  «{covered}»").expect("a string takes any text");
    }

    fn inside(&mut self, f: impl FnOnce(&mut Self)) {
        self.indent += 1;
        f(self);
        self.indent -= 1;
    }

    fn body(&mut self, body: &Body) {
        for entry in &body.entries {
            match entry {
                Entry::Field(field) => {
                    self.expr(&format!("{}: ", named(self.text, &field.name)), &field.value)
                }
                Entry::Statement(statement) => self.statement(statement),
                Entry::Rows(_) => unreachable!("`parse` writes them out"),
                Entry::Broken(broken) => {
                    let name = broken.name.as_ref().map_or("-", |name| named(self.text, name));
                    self.line(&format!("broken {name}"), broken.span);
                }
            }
        }
    }

    fn statement(&mut self, statement: &Statement) {
        if let Some(doc) = &statement.doc {
            writeln!(self.out, "{}doc {doc:?}", "  ".repeat(self.indent.min(12)))
                .expect("a string takes any text");
        }
        for prefix in &statement.prefixes {
            self.line(&format!("@{}", named(self.text, &prefix.name)), prefix.span);
            self.inside(|dump| prefix.arguments.iter().for_each(|arguments| dump.arguments(arguments)));
        }
        self.statement_kind(&statement.kind, statement.span);
    }

    fn statement_kind(&mut self, kind: &StatementKind, span: Span) {
        match kind {
            StatementKind::Thing { name, construct } => {
                let name = name.as_ref().map_or("-", |name| named(self.text, name));
                self.construct(&format!("thing {name} = "), construct);
            }
            StatementKind::Definition { keyword, name, value } => {
                self.line(&format!("{keyword:?} {}", named(self.text, name)), span);
                self.inside(|dump| dump.expr("", value));
            }
            StatementKind::Param { name, ty, default, range } => {
                self.line(&format!("param {}: {}", named(self.text, name), type_name(ty)), span);
                self.inside(|dump| {
                    dump.expr("= ", default);
                    range.iter().for_each(|range| dump.expr("in ", range));
                });
            }
            StatementKind::Part { name, body } => {
                self.line(&format!("part {}", named(self.text, name)), span);
                self.inside(|dump| dump.body(body));
            }
            StatementKind::Import { path, name } => {
                self.line(&format!("import {:?} as {}", path.text, name.text), span);
            }
            StatementKind::Function { name, parameters, result, value } => {
                let parameter = |p: &rt_lang::syntax::ast::Parameter| {
                    format!("{}: {}", named(self.text, &p.name), type_name(&p.ty))
                };
                let parameters: Vec<String> = parameters.iter().map(parameter).collect();
                let (name, result) = (named(self.text, name), type_name(result));
                self.line(&format!("fn {name}({}) -> {result}", parameters.join(", ")), span);
                self.inside(|dump| dump.expr("", value));
            }
            StatementKind::For { variable, list, body } => {
                self.line(&format!("for {}", named(self.text, variable)), span);
                self.inside(|dump| {
                    dump.expr("in ", list);
                    dump.body(body);
                });
            }
            StatementKind::If { condition, then, otherwise } => {
                self.line("if", span);
                self.inside(|dump| {
                    dump.expr("", condition);
                    dump.inside(|dump| dump.body(then));
                    if let Some(otherwise) = otherwise {
                        dump.line("else", otherwise.span);
                        dump.inside(|dump| dump.body(otherwise));
                    }
                });
            }
            StatementKind::Assert { condition, message } => {
                self.line("assert", span);
                self.inside(|dump| {
                    dump.expr("", condition);
                    message.iter().for_each(|message| dump.expr("message ", message));
                });
            }
        }
    }

    fn arguments(&mut self, arguments: &[Argument]) {
        for argument in arguments {
            let name = argument.name.as_ref().map_or(String::new(), |name| format!("{}: ", name.text));
            self.expr(&name, &argument.value);
        }
    }

    fn construct(&mut self, before: &str, construct: &Construct) {
        self.line(&format!("{before}{} {{}}", path(self.text, &construct.kind)), construct.span);
        assert!(construct.span.contains(construct.body.span));
        self.inside(|dump| dump.body(&construct.body));
    }

    fn expr(&mut self, before: &str, expr: &Expr) {
        let text = self.text;
        let mut line = |what: String| self.line(&format!("{before}{what}"), expr.span);
        match &expr.kind {
            ExprKind::Invalid => line("invalid".into()),
            ExprKind::Number { value, int: true } => line(format!("int {value}")),
            ExprKind::Number { value, int: false } => line(format!("number {value}")),
            ExprKind::Quantity { value, unit } => line(format!("quantity {value} {}", unit.text)),
            ExprKind::Bool(value) => line(format!("bool {value}")),
            ExprKind::Text(value) => line(format!("text {value:?}")),
            ExprKind::Color(digits) => line(format!("color {digits}")),
            ExprKind::Name(name) => line(format!("name {name}")),
            ExprKind::Scaled { value, unit } => {
                line(format!("scaled {}", unit.text));
                self.inside(|dump| dump.expr("", value));
            }
            ExprKind::Tuple(values) => {
                line("tuple".into());
                self.inside(|dump| values.iter().for_each(|value| dump.expr("", value)));
            }
            ExprKind::Paren(value) => {
                line("paren".into());
                self.inside(|dump| dump.expr("", value));
            }
            ExprKind::Call { function, arguments } => {
                let names = std::iter::once(&function.first).chain(&function.rest);
                line(format!("call {}", names.map(|name| name.text.as_str()).collect::<Vec<_>>().join(".")));
                self.inside(|dump| dump.arguments(arguments));
            }
            ExprKind::List(values) => {
                line("list".into());
                self.inside(|dump| values.iter().for_each(|value| dump.expr("", value)));
            }
            ExprKind::Index { value, index } => {
                line("index".into());
                self.inside(|dump| {
                    dump.expr("", value);
                    dump.expr("at ", index);
                });
            }
            ExprKind::If { condition, then, otherwise } => {
                line("if".into());
                self.inside(|dump| {
                    dump.expr("", condition);
                    dump.expr("then ", then);
                    dump.expr("else ", otherwise);
                });
            }
            ExprKind::Member { value, member } => {
                line(format!("member .{}", member.text));
                self.inside(|dump| dump.expr("", value));
            }
            ExprKind::Construct(construct) => self.construct(before, construct),
            ExprKind::Unary { operator, operand } => {
                line(format!("{operator:?}"));
                self.inside(|dump| dump.expr("", operand));
            }
            ExprKind::Binary { operator, at, left, right } => {
                line(format!("{operator:?} {}", &text[at.range()]));
                self.inside(|dump| {
                    dump.expr("", left);
                    dump.expr("", right);
                });
            }
        }
    }
}

fn path(text: &str, path: &Path) -> String {
    let names = std::iter::once(&path.first).chain(&path.rest);
    names.map(|name| named(text, name)).collect::<Vec<_>>().join(".")
}

fn type_name(ty: &TypeName) -> String {
    match ty {
        TypeName::Named(name) => name.text.to_string(),
        TypeName::List(inner, _) => format!("[{}]", type_name(inner)),
        TypeName::Invalid(_) => "invalid".into(),
    }
}

/// A name, whose span must cover just it.
fn named<'t>(text: &str, name: &'t Name) -> &'t str {
    assert_eq!(&text[name.span.range()], name.text);
    &name.text
}

fn shorten(text: &str) -> String {
    let line = text.replace('\r', "␍").replace('\n', "␤").replace('\u{1}', "␁");
    if line.chars().count() <= 48 {
        return line;
    }
    let (head, tail): (String, String) = (line.chars().take(30).collect(), {
        let skipped = line.chars().count() - 15;
        line.chars().skip(skipped).collect()
    });
    format!("{head} … {tail}")
}

/// What is said of a text, with every part of it.
pub fn diagnostics(text: &str, diagnostics: &[Diagnostic]) -> String {
    let mut out = String::new();
    for diagnostic in diagnostics {
        let Diagnostic { code, message, primary, labels, help, fix, .. } = diagnostic;
        writeln!(out, "{} {} × {message}", code.as_str(), place(text, primary.span.start))
            .expect("a string takes any text");
        write_label(&mut out, text, "at ", primary);
        labels.iter().for_each(|label| write_label(&mut out, text, "and", label));
        if let Some(help) = help {
            writeln!(out, "  help: {help}").expect("a string takes any text");
        }
        for (span, replacement) in fix.iter().flat_map(|fix| &fix.edits) {
            let covered = shorten(&text[span.range()]);
            writeln!(out, "  fix: {} «{covered}» → «{replacement}»", place(text, span.start))
                .expect("a string takes any text");
        }
    }
    out
}

fn write_label(out: &mut String, text: &str, word: &str, label: &Label) {
    let covered = shorten(&text[label.span.range()]);
    writeln!(out, "  {word} {} «{covered}» {}", place(text, label.span.start), label.text)
        .expect("a string takes any text");
}

fn place(text: &str, offset: u32) -> String {
    let before = &text[..offset as usize];
    let line = before.rfind('\n').map_or(0, |newline| newline + 1);
    format!("{}:{}", before.matches('\n').count() + 1, before[line..].chars().count() + 1)
}

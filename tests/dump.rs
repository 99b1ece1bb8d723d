//! Trees and diagnostics as text for snapshots.

use rt_lang::diagnostic::{Diagnostic, Label};
use rt_lang::span::Span;
use rt_lang::syntax::ast::{Body, Construct, Entry, Expr, ExprKind, File, Name, Statement};
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
                Entry::Broken(broken) => {
                    let name = broken.name.as_ref().map_or("-", |name| named(self.text, name));
                    self.line(&format!("broken {name}"), broken.span);
                }
            }
        }
    }

    fn statement(&mut self, statement: &Statement) {
        match statement {
            Statement::Thing { name, construct } => {
                let name = name.as_ref().map_or("-", |name| named(self.text, name));
                self.construct(&format!("thing {name} = "), construct);
            }
            Statement::Definition { keyword, name, value, span } => {
                self.line(&format!("{keyword:?} {}", named(self.text, name)), *span);
                self.inside(|dump| dump.expr("", value));
            }
        }
    }

    fn construct(&mut self, before: &str, construct: &Construct) {
        self.line(&format!("{before}{} {{}}", named(self.text, &construct.kind)), construct.span);
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
                line(format!("call {}", function.text));
                self.inside(|dump| {
                    for argument in arguments {
                        let name =
                            argument.name.as_ref().map_or(String::new(), |name| format!("{}: ", name.text));
                        dump.expr(&name, &argument.value);
                    }
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

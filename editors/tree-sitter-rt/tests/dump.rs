//! A tree as lines: what was written, with its places, the same for both parsers.

use rt_lang::span::Span;
use rt_lang::syntax::ast::{
    Argument, Body, Construct, Entry, Expr, ExprKind, Keyword, Path, Statement, StatementKind, TypeName,
    UnaryOp,
};
use std::ops::Range;
use tree_sitter::Node;

/// Lines, each indented by its depth.
#[derive(Default)]
struct Lines {
    out: String,
    depth: usize,
}

impl Lines {
    fn line(&mut self, what: &str, place: Range<usize>) {
        let indent = "  ".repeat(self.depth);
        self.out += &format!("{indent}{what} {}..{}\n", place.start, place.end);
    }

    fn inside(&mut self, f: impl FnOnce(&mut Lines)) {
        self.depth += 1;
        f(self);
        self.depth -= 1;
    }
}

// --- The compiler's tree ----------------------------------------------------------------------------------------

/// The compiler's entries, which have no slip.
pub fn of_compiler(body: &Body) -> String {
    let mut lines = Lines::default();
    entries(&mut lines, body);
    lines.out
}

fn entries(lines: &mut Lines, body: &Body) {
    for entry in &body.entries {
        match entry {
            Entry::Field(field) => {
                let place = field.name.span.start as usize..field.value.span.end as usize;
                lines.line(&format!("field {}", field.name.text), place);
                lines.inside(|lines| expression(lines, &field.value));
            }
            Entry::Statement(it) => statement(lines, it),
            Entry::Rows(_) | Entry::Broken(_) => lines.line("broken", 0..0),
        }
    }
}

fn statement(lines: &mut Lines, statement: &Statement) {
    for prefix in &statement.prefixes {
        lines.line(&format!("mark {}", prefix.name.text), prefix.span.range());
        lines.inside(|lines| prefix.arguments.iter().for_each(|given| arguments(lines, given)));
    }
    let place = statement.span.range();
    match &statement.kind {
        StatementKind::Thing { name, construct } => {
            let name = name.as_ref().map_or("-", |name| &name.text);
            lines.line(&format!("thing {} {name}", path(&construct.kind)), place);
            lines.inside(|lines| entries(lines, &construct.body));
        }
        StatementKind::Definition { keyword, name, value } => {
            let word = if *keyword == Keyword::Let { "let" } else { "material" };
            lines.line(&format!("{word} {}", name.text), place);
            lines.inside(|lines| expression(lines, value));
        }
        StatementKind::Param { name, ty, default, range } => {
            lines.line(&format!("param {}: {}", name.text, type_name(ty)), place);
            lines.inside(|lines| {
                expression(lines, default);
                range.iter().for_each(|range| expression(lines, range));
            });
        }
        StatementKind::Part { name, body } => {
            lines.line(&format!("part {}", name.text), place);
            lines.inside(|lines| entries(lines, body));
        }
        StatementKind::Import { path, name } => {
            lines.line(&format!("import {} {:?}", name.text, path.span.range()), place);
        }
        StatementKind::Function { name, parameters, result, value } => {
            let taken: Vec<String> =
                parameters.iter().map(|p| format!("{}: {}", p.name.text, type_name(&p.ty))).collect();
            let head = format!("fn {}({}) -> {}", name.text, taken.join(", "), type_name(result));
            lines.line(&head, place);
            lines.inside(|lines| expression(lines, value));
        }
        StatementKind::For { variable, list, body } => {
            lines.line(&format!("for {}", variable.text), place);
            lines.inside(|lines| {
                expression(lines, list);
                entries(lines, body);
            });
        }
        StatementKind::If { condition, then, otherwise } => {
            lines.line("if", place);
            lines.inside(|lines| {
                expression(lines, condition);
                entries(lines, then);
                if let Some(otherwise) = otherwise {
                    lines.line("else", otherwise.span.range());
                    lines.inside(|lines| entries(lines, otherwise));
                }
            });
        }
        StatementKind::Assert { condition, message } => {
            lines.line("assert", place);
            lines.inside(|lines| {
                expression(lines, condition);
                message.iter().for_each(|message| expression(lines, message));
            });
        }
    }
}

fn arguments(lines: &mut Lines, arguments: &[Argument]) {
    for Argument { name, value } in arguments {
        let label = name.as_ref().map_or("-", |name| &name.text);
        let start = name.as_ref().map_or(value.span.start, |name| name.span.start);
        lines.line(&format!("argument {label}"), start as usize..value.span.end as usize);
        lines.inside(|lines| expression(lines, value));
    }
}

fn path(path: &Path) -> String {
    let names = std::iter::once(&path.first).chain(&path.rest);
    names.map(|name| name.text.as_str()).collect::<Vec<_>>().join(".")
}

fn type_name(ty: &TypeName) -> String {
    match ty {
        TypeName::Named(name) => name.text.to_string(),
        TypeName::List(inner, _) => format!("[{}]", type_name(inner)),
        TypeName::Invalid(_) => "invalid".into(),
    }
}

fn expression(lines: &mut Lines, expr: &Expr) {
    let all = |lines: &mut Lines, values: &[Expr]| values.iter().for_each(|value| expression(lines, value));
    let place = expr.span.range();
    match &expr.kind {
        ExprKind::Invalid => lines.line("invalid", place),
        ExprKind::Number { .. } => lines.line("number", place),
        ExprKind::Quantity { unit, .. } => lines.line(&format!("quantity {}", unit.text), place),
        ExprKind::Bool(_) => lines.line("boolean", place),
        ExprKind::Text(_) => lines.line("text", place),
        ExprKind::Color(_) => lines.line("color", place),
        ExprKind::Name(name) => lines.line(&format!("name {name}"), place),
        ExprKind::Scaled { value, unit } => {
            lines.line(&format!("scaled {}", unit.text), place);
            lines.inside(|lines| expression(lines, value));
        }
        ExprKind::Tuple(values) => {
            lines.line("tuple", place);
            lines.inside(|lines| all(lines, values));
        }
        ExprKind::List(values) => {
            lines.line("list", place);
            lines.inside(|lines| all(lines, values));
        }
        ExprKind::Paren(value) => {
            lines.line("parenthesized", place);
            lines.inside(|lines| expression(lines, value));
        }
        ExprKind::Call { function, arguments: given } => {
            lines.line(&format!("call {}", path(function)), place);
            lines.inside(|lines| arguments(lines, given));
        }
        ExprKind::Member { value, member } => {
            lines.line(&format!("member {}", member.text), place);
            lines.inside(|lines| expression(lines, value));
        }
        ExprKind::Index { value, index } => {
            lines.line("index", place);
            lines.inside(|lines| {
                expression(lines, value);
                expression(lines, index);
            });
        }
        ExprKind::If { condition, then, otherwise } => {
            lines.line("conditional", place);
            lines.inside(|lines| {
                [condition, then, otherwise].into_iter().for_each(|part| expression(lines, part))
            });
        }
        ExprKind::Construct(construct) => {
            let Construct { kind, body, span } = &**construct;
            lines.line(&format!("construct {}", path(kind)), Span::range(*span));
            lines.inside(|lines| entries(lines, body));
        }
        ExprKind::Unary { operator, operand } => {
            lines.line(if *operator == UnaryOp::Not { "unary not" } else { "unary -" }, place);
            lines.inside(|lines| expression(lines, operand));
        }
        ExprKind::Binary { operator, left, right, .. } => {
            lines.line(&format!("binary {}", operator.symbol()), place);
            lines.inside(|lines| {
                expression(lines, left);
                expression(lines, right);
            });
        }
    }
}

// --- The tree for editors ---------------------------------------------------------------------------------------

/// The entries of a tree without an error.
pub fn of_editor(text: &str, root: Node) -> String {
    let mut reader = Reader { text, lines: Lines::default() };
    reader.entries(root);
    reader.lines.out
}

struct Reader<'t> {
    text: &'t str,
    lines: Lines,
}

fn child<'t>(node: Node<'t>, field: &str) -> Node<'t> {
    node.child_by_field_name(field).unwrap_or_else(|| panic!("{} has no {field}", node.to_sexp()))
}

/// The parts that are no comments.
fn parts(node: Node) -> Vec<Node> {
    let all = (0..node.named_child_count()).filter_map(|index| node.named_child(index as u32));
    all.filter(|part| !part.is_extra()).collect()
}

impl<'t> Reader<'t> {
    fn str(&self, node: Node) -> &'t str {
        &self.text[node.byte_range()]
    }

    fn field(&self, node: Node, field: &str) -> &'t str {
        self.str(child(node, field))
    }

    fn line(&mut self, what: &str, node: Node) {
        self.lines.line(what, node.byte_range());
    }

    fn inside(&mut self, f: impl FnOnce(&mut Self)) {
        self.lines.depth += 1;
        f(self);
        self.lines.depth -= 1;
    }

    /// The names of a path, or the one name.
    fn path(&self, node: Node) -> String {
        if node.kind() == "path" {
            parts(node).into_iter().map(|name| self.str(name)).collect::<Vec<_>>().join(".")
        } else {
            self.str(node).into()
        }
    }

    fn type_name(&self, node: Node) -> String {
        match node.kind() {
            "list_type" => format!("[{}]", self.type_name(parts(node)[0])),
            _ => self.str(node).into(),
        }
    }

    fn entries(&mut self, body: Node) {
        for entry in parts(body) {
            self.entry(entry);
        }
    }

    fn entry(&mut self, node: Node) {
        match node.kind() {
            "field" => {
                self.line(&format!("field {}", self.field(node, "name")), node);
                self.inside(|reader| reader.expression(child(node, "value")));
            }
            "mark" => {
                self.line(&format!("mark {}", self.field(node, "name")), node);
                self.inside(|reader| {
                    node.child_by_field_name("arguments")
                        .into_iter()
                        .for_each(|given| reader.arguments(given));
                });
            }
            "thing" => {
                let name = node.child_by_field_name("name").map_or("-", |name| self.str(name));
                self.line(&format!("thing {} {name}", self.path(child(node, "kind"))), node);
                self.inside(|reader| reader.entries(child(node, "body")));
            }
            "definition" => {
                self.line(&format!("{} {}", self.field(node, "keyword"), self.field(node, "name")), node);
                self.inside(|reader| reader.expression(child(node, "value")));
            }
            "param" => {
                let ty = self.type_name(child(node, "type"));
                self.line(&format!("param {}: {ty}", self.field(node, "name")), node);
                self.inside(|reader| {
                    reader.expression(child(node, "default"));
                    node.child_by_field_name("range").into_iter().for_each(|range| reader.expression(range));
                });
            }
            "part" => {
                self.line(&format!("part {}", self.field(node, "name")), node);
                self.inside(|reader| reader.entries(child(node, "body")));
            }
            "import" => {
                let place = child(node, "path").byte_range();
                self.line(&format!("import {} {place:?}", self.field(node, "name")), node);
            }
            "function" => self.function(node),
            "for_statement" => {
                self.line(&format!("for {}", self.field(node, "variable")), node);
                self.inside(|reader| {
                    reader.expression(child(node, "list"));
                    reader.entries(child(node, "body"));
                });
            }
            "if_statement" => self.choice(node),
            "assertion" => {
                self.line("assert", node);
                self.inside(|reader| {
                    reader.expression(child(node, "condition"));
                    node.child_by_field_name("message")
                        .into_iter()
                        .for_each(|given| reader.expression(given));
                });
            }
            other => panic!("`{other}` is no entry: {}", node.to_sexp()),
        }
    }

    fn function(&mut self, node: Node) {
        let parameter =
            |it: Node| format!("{}: {}", self.field(it, "name"), self.type_name(child(it, "type")));
        let taken: Vec<String> = parts(child(node, "parameters")).into_iter().map(parameter).collect();
        let (name, result) = (self.field(node, "name"), self.type_name(child(node, "type")));
        self.line(&format!("fn {name}({}) -> {result}", taken.join(", ")), node);
        self.inside(|reader| reader.expression(child(node, "value")));
    }

    fn choice(&mut self, node: Node) {
        self.line("if", node);
        self.inside(|reader| {
            reader.expression(child(node, "condition"));
            reader.entries(child(node, "then"));
            if let Some(otherwise) = node.child_by_field_name("else") {
                reader.line("else", otherwise);
                reader.inside(|reader| match otherwise.kind() {
                    "body" => reader.entries(otherwise),
                    _ => reader.entry(otherwise),
                });
            }
        });
    }

    fn arguments(&mut self, node: Node) {
        for argument in parts(node) {
            let label = argument.child_by_field_name("name").map_or("-", |name| self.str(name));
            self.line(&format!("argument {label}"), argument);
            self.inside(|reader| reader.expression(child(argument, "value")));
        }
    }

    fn all(&mut self, node: Node) {
        self.inside(|reader| parts(node).into_iter().for_each(|value| reader.expression(value)));
    }

    fn expression(&mut self, node: Node) {
        match node.kind() {
            kind @ ("number" | "boolean" | "text" | "color") => self.line(kind, node),
            "identifier" => self.line(&format!("name {}", self.str(node)), node),
            "quantity" => self.line(&format!("quantity {}", self.field(node, "unit")), node),
            "scaled" => {
                self.line(&format!("scaled {}", self.field(node, "unit")), node);
                self.inside(|reader| reader.expression(child(node, "value")));
            }
            kind @ ("tuple" | "list" | "parenthesized") => {
                self.line(kind, node);
                self.all(node);
            }
            "path" => self.members(&parts(node)),
            "member" => {
                self.line(&format!("member {}", self.field(node, "member")), node);
                self.inside(|reader| reader.expression(child(node, "value")));
            }
            "index" => {
                self.line("index", node);
                self.all(node);
            }
            "call" => {
                self.line(&format!("call {}", self.path(child(node, "function"))), node);
                self.inside(|reader| reader.arguments(child(node, "arguments")));
            }
            "construct" => {
                self.line(&format!("construct {}", self.path(child(node, "kind"))), node);
                self.inside(|reader| reader.entries(child(node, "body")));
            }
            "conditional" => {
                self.line("conditional", node);
                self.all(node);
            }
            "unary" => {
                self.line(&format!("unary {}", self.field(node, "operator")), node);
                self.inside(|reader| reader.expression(child(node, "operand")));
            }
            "binary" => {
                self.line(&format!("binary {}", self.field(node, "operator")), node);
                self.all(node);
            }
            other => panic!("`{other}` is no expression: {}", node.to_sexp()),
        }
    }

    /// `a.b.c` by itself: what the compiler takes for members within each other.
    fn members(&mut self, names: &[Node]) {
        match names {
            [] => {}
            [name] => self.line(&format!("name {}", self.str(*name)), *name),
            [first, .., last] => {
                let place = first.start_byte()..last.end_byte();
                self.lines.line(&format!("member {}", self.str(*last)), place);
                self.inside(|reader| reader.members(&names[..names.len() - 1]));
            }
        }
    }
}

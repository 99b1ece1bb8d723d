//! What is said of statements that begin with a word of their own, and of what stands before them.

use super::unexpected;
use crate::diagnostic::{Code, Diagnostic};
use crate::span::Span;
use crate::syntax::ast::{ExprKind, Name, Prefix};
use crate::syntax::is_name;

/// How the statement that begins with a word is written.
fn form(word: &str) -> &'static str {
    match word {
        "param" => "param name: type = value",
        "part" => "part name { … }",
        "import" => "import \"file.rt\" as name",
        "for" => "for name in list { … }",
        "if" => "if condition { … } else { … }",
        "fn" => "fn name(a: type) -> type = value",
        "assert" => "assert condition, \"message\"",
        "else" | "elif" => "if condition { … } else { … }",
        "then" => "if condition then value else value",
        "in" => "for name in list { … }",
        "as" => "import \"file.rt\" as name",
        "to" => "for name in low to high { … }",
        "material" => "material name = value",
        _ => "let name = value",
    }
}

fn missing(what: &str, place: Span, word: &str) -> Diagnostic {
    Diagnostic::new(Code::E0001, what, place).help(format!("write `{}`", form(word)))
}

/// A statement of which too little can be told: `for (i in x) {`, `part`.
pub(in crate::syntax) fn unfinished(word: &str, span: Span) -> Diagnostic {
    missing(&format!("this `{word}` cannot be understood"), span, word).at("is written otherwise")
}

/// A word of the language where a statement begins that is not of its form: `else { … }`, `let: x = 3`.
pub(in crate::syntax) fn begins_nothing(word: &str, span: Span) -> Diagnostic {
    if matches!(word, "param" | "part" | "import" | "for" | "if" | "fn" | "assert" | "material" | "let") {
        return unfinished(word, span);
    }
    missing(&format!("unexpected `{word}`"), span, word).at("nothing begins with this word")
}

/// `param x = 5`, `fn f(a: number) = a`
pub(in crate::syntax) fn missing_type(of: &str, place: Span, word: &str) -> Diagnostic {
    missing(&format!("the type of {of} is missing"), place, word).at("a type belongs here, such as `length`")
}

/// `param x: 5`
pub(in crate::syntax) fn not_a_type(text: &str, span: Span) -> Diagnostic {
    unexpected(text, span)
        .at("a type belongs here")
        .help("a type is a word such as `number` or `length`, or a list as in `[color]`")
}

/// `param x int = 5`
pub(in crate::syntax) fn missing_type_colon(name: &str, span: Span, ty: Span) -> Diagnostic {
    Diagnostic::new(Code::E0005, format!("`:` is missing after `{name}`"), span)
        .at("what is declared")
        .label(ty, "its type")
        .help(format!("write `{name}: type`"))
        .fix(span.after(), ":")
}

/// `param int count = 5`, `fn f(length x) -> length = x`
pub(in crate::syntax) fn type_first(ty: &Name, name: &Name) -> Diagnostic {
    let right = format!("{}: {}", name.text, ty.text);
    Diagnostic::new(Code::E0005, "a type stands behind its name", ty.span)
        .at("a type")
        .label(name.span, "what is declared")
        .help(format!("write `{right}`"))
        .fix(ty.span.to(name.span), right)
}

/// `h: length = 1m` in a part, or in a file.
pub(in crate::syntax) fn missing_param(name: &Name, ty: &str) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("`param` is missing before `{}`", name.text), name.span)
        .at("a setting is declared by its word")
        .help(format!("write `param {}: {ty} = …`", name.text))
        .fix(name.span.before(), "param ")
}

/// `radius: length = 1m` in a thing. `edit` is from behind the name to the sign.
pub(in crate::syntax) fn type_in_field(name: &str, ty: Span, edit: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("the field `{name}` takes no type"), ty)
        .at("follows from the field")
        .help(format!("write `{name}: …`; only a `param` and a `fn` name types"))
        .fix(edit, ":")
}

/// `param n: int in 1 to 20 = 5`. `whole` is from the range on.
pub(in crate::syntax) fn range_first(name: &str, sign: Span, whole: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("the default of `{name}` stands behind its range"), sign)
        .at("belongs before `in`")
        .label(Span { end: sign.start, ..whole }, "the range")
        .help("write `param name: type = value in low to high`")
}

/// `param r: length = 1m from 0m to 3m`
pub(in crate::syntax) fn range_from(span: Span) -> Diagnostic {
    unexpected("from", span)
        .at("`in` is wanted")
        .help("write `param name: type = value in low to high`")
        .fix(span, "in")
}

/// `part p(h: length) { … }`
pub(in crate::syntax) fn part_takes(name: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("the part `{name}` takes no parameters"), span)
        .at("is declared inside")
        .help(format!("what can be set is a `param`: `part {name} {{ param size: length = 10cm … }}`"))
}

/// `for b in ball { radius: 2m } { … }`
pub(in crate::syntax) fn changed_in_head(thing: Span, body: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, "a changed prototype in the head of a loop stands in parentheses", body)
        .at("taken for the body of the loop")
        .help("write `(ball { … })`")
        .fix(thing.before(), "(")
        .fix(thing.after(), ")")
}

/// `assert(a == b, "message")`. The places are those of the parentheses.
pub(in crate::syntax) fn assert_parentheses(open: Span, close: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, "`assert` has no parentheses", open)
        .at("is no call")
        .help("write `assert condition, \"message\"`")
        .fix(open, " ")
        .fix(close, "")
}

/// `if c then { … }` as a statement.
pub(in crate::syntax) fn then_before_block(span: Span) -> Diagnostic {
    unexpected("then", span)
        .at("`{` follows the condition at once")
        .help("write `if … { … } else { … }`")
        .fix(span, "")
}

/// `param x: int`
pub(in crate::syntax) fn missing_default(name: &str, place: Span) -> Diagnostic {
    missing(&format!("`param {name}` has no default"), place, "param").at("`=` and a value belong here")
}

/// `:=` for `=`.
pub(in crate::syntax) fn not_equals(word: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0003, format!("the value of this `{word}` follows `=`"), span)
        .at("`=` is wanted")
        .help(format!("write `{}`", form(word)))
        .fix(span, "=")
}

/// `part stool`, `for i in list`, `if c`
pub(in crate::syntax) fn missing_block(word: &str, place: Span) -> Diagnostic {
    missing(&format!("the body of this `{word}` is missing"), place, word).at("`{ … }` belongs here")
}

/// Whether it tells of a `{` that is missing, so that its `}` closes nothing.
pub(in crate::syntax) fn misses_brace(diagnostic: &Diagnostic) -> bool {
    let message = &diagnostic.message;
    diagnostic.code == Code::E0001
        && (message.starts_with("`{` is missing")
            || message.starts_with("the body of this")
            || message.ends_with("has no body"))
}

/// `part stool = group { … }`
pub(in crate::syntax) fn part_is_no_value(name: &str, sign: Span) -> Diagnostic {
    unexpected("=", sign)
        .at("the braces follow the name")
        .help(format!("write `part {name} {{ … }}`, or `let {name} = …` for one thing"))
}

/// `for i = 0 to 3`; `sign` is empty where nothing stands between the two.
pub(in crate::syntax) fn missing_in(sign: &str, span: Span) -> Diagnostic {
    if sign.is_empty() {
        return missing("`in` is missing after the name", span, "for")
            .at("`in` belongs here")
            .fix(span, " in");
    }
    unexpected(sign, span).at("`in` is wanted").help(format!("write `{}`", form("for"))).fix(span, "in")
}

/// `for i = 0; i < 3; i++ { … }`
pub(in crate::syntax) fn counting_loop(head: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, "a `for` goes through a list or a range", head)
        .at("is written otherwise")
        .help("write `for i in range(3) { … }`, where `i` is 0, 1 and 2")
}

/// `for (i in list) { … }`, `for (i = 0; i < 3; i++) { … }`; `touches` is whether the head does so the word before it.
pub(in crate::syntax) fn head_in_parentheses(head: &str, span: Span, touches: bool) -> Diagnostic {
    let inside = head.strip_prefix('(').and_then(|head| head.strip_suffix(')')).map(str::trim_ascii);
    let inside = inside.filter(|inside| {
        let name = crate::syntax::leading(inside, "");
        let behind = inside[name.len()..].trim_ascii_start();
        is_name(name) && crate::syntax::leading(behind, "") == "in" && crate::syntax::pairs(inside)
    });
    let Some(inside) = inside else {
        return counting_loop(span);
    };
    Diagnostic::new(Code::E0001, "the head of a `for` has no parentheses", span)
        .at("no parentheses belong here")
        .help(format!("write `for {inside} {{ … }}`"))
        .fix(span, format!("{}{inside}", if touches { " " } else { "" }))
}

/// `for each i in list`; `span` is up to the second word.
pub(in crate::syntax) fn named_twice(word: &str, name: &str, span: Span) -> Diagnostic {
    let diagnostic = Diagnostic::new(
        Code::E0001,
        format!("unexpected `{word}`"),
        Span { end: span.start + word.len() as u32, ..span },
    )
    .at("one name belongs between `for` and `in`")
    .help(format!("write `for {name} in list {{ … }}`"));
    // Of two names either may be used in the body.
    match word == name || matches!(word, "each" | "every" | "all" | "var" | "let" | "const" | "mut" | "int") {
        true => diagnostic.fix(span, ""),
        false => diagnostic,
    }
}

/// `for i in x: {`
pub(in crate::syntax) fn before_block(token: &str, span: Span) -> Diagnostic {
    unexpected(token, span).at("the body should begin here").help(match token {
        ":" | "do" | "then" | "begin" | ")" => "leave it out: `{` follows at once",
        "step" | "by" => "a range goes in steps of 1: multiply, as `2 * i` in `for i in 0 to 5 { … }`",
        _ => "`{` follows the head at once, in which an operator may be missing",
    })
}

/// `elif`, `elseif`
pub(in crate::syntax) fn else_if(word: &str, span: Span) -> Diagnostic {
    unexpected(word, span).at("`else if` is wanted").help("write `else if`").fix(span, "else if")
}

/// `else` with neither braces nor `if` behind it.
pub(in crate::syntax) fn missing_else_block(span: Span) -> Diagnostic {
    missing("the body of this `else` is missing", span, "else").at("`{ … }` or `if` belongs behind this")
}

/// `if c then sphere {}` as a statement.
pub(in crate::syntax) fn then_in_statement(span: Span) -> Diagnostic {
    unexpected("then", span)
        .at("`{` is wanted")
        .help("`if … then … else …` is a value; a statement is written `if … { … } else { … }`")
}

/// `if c { 1 } else { 2 }` as a value.
pub(in crate::syntax) fn braces_in_value(span: Span) -> Diagnostic {
    unexpected("{", span).at("`then` is wanted").help("as a value, a choice is written `if … then … else …`")
}

/// `if c 1 else 2`, or nothing more.
pub(in crate::syntax) fn missing_then(place: Span, token: &str) -> Diagnostic {
    let diagnostic = missing("`then` is missing", place, "then").at("`then` and a value belong here");
    match token {
        "&" => diagnostic.help("both conditions at once are written `a and b`"),
        "|" => diagnostic.help("either condition is written `a or b`"),
        _ => diagnostic,
    }
}

/// `if c then 1`
pub(in crate::syntax) fn missing_else(place: Span) -> Diagnostic {
    missing("`else` is missing", place, "then").at("`else` and a value belong here: every value is something")
}

/// `1 + if …`
pub(in crate::syntax) fn loose_if(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, "`if` behind an operator stands in parentheses", span)
        .at("binds looser than the operator")
        .help("write `1 + (if … then … else …)`")
}

/// `import lantern.rt as lantern`
pub(in crate::syntax) fn bare_path(path: &str, span: Span) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::E0001, "the path of a file stands in quotes", span)
        .at("a text belongs here")
        .help(format!("write `{}`", form("import")));
    if path.ends_with(".rt") && !path.contains(['"', '\\', ' ', '\t', '\u{1}']) {
        return diagnostic.fix(span, format!("\"{path}\""));
    }
    diagnostic
}

/// `import lantern from "lantern.rt"`
pub(in crate::syntax) fn path_behind(name: &str, path: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, "the path of a file stands before its name", span)
        .at("the other way round")
        .help(format!("write `import {path} as {name}`"))
        .fix(span, format!("{path} as {name}"))
}

/// `import "lantern.rt"`; `name` is what the file may be called, and `edit` what mends it at the place.
pub(in crate::syntax) fn missing_as(name: Option<&str>, edit: Option<String>, place: Span) -> Diagnostic {
    let diagnostic = Diagnostic::new(Code::E0001, "the imported file has no name", place)
        .at("`as` and a name belong here")
        .help(
            name.map_or_else(|| format!("write `{}`", form("import")), |name| format!("write `as {name}`")),
        );
    match edit {
        Some(edit) => diagnostic.fix(place, edit),
        None => diagnostic,
    }
}

/// `as` with nothing behind it.
pub(in crate::syntax) fn missing_import_name(place: Span) -> Diagnostic {
    missing("a name is missing after `as`", place, "import").at("by what is it used?")
}

/// `fn f = 5`
pub(in crate::syntax) fn missing_parameters(place: Span) -> Diagnostic {
    missing("the parameters are missing", place, "fn").at("`(…)` belongs here, also where there are none")
}

/// `fn f a: number -> number = a`
pub(in crate::syntax) fn bare_parameters(name: &str, span: Span) -> Diagnostic {
    missing(&format!("the parameters of `{name}` have no parentheses"), span, "fn")
        .at("`(…)` belongs around these")
}

/// Whether it tells of parameters without parentheses, so that their `)` closes nothing.
pub(in crate::syntax) fn misses_parentheses(diagnostic: &Diagnostic) -> bool {
    diagnostic.message.starts_with("the parameters of ")
        && diagnostic.message.ends_with(" have no parentheses")
}

/// `for in list { … }`
pub(in crate::syntax) fn missing_variable(span: Span) -> Diagnostic {
    missing("a name is missing after `for`", span, "for").at("what is each of them called?")
}

/// `for i, j in list { … }`
pub(in crate::syntax) fn several_variables(span: Span) -> Diagnostic {
    unexpected(",", Span { end: span.start + 1, ..span })
        .at("a loop has one variable")
        .help("put one loop into another: `for i in range(3) { for j in range(4) { … } }`")
}

/// `if c sphere { … }`
pub(in crate::syntax) fn unbraced_thing(word: &str, kind: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("`{{` is missing before `{kind}`"), span)
        .at(format!("the body of this `{word}` belongs here"))
        .help(match word {
            "else" => format!("put it into braces of its own: `else {{ {kind} {{ … }} }}`"),
            "for" => format!("put it into braces of its own: `for … in … {{ {kind} {{ … }} }}`"),
            _ => format!("put it into braces of its own: `{word} … {{ {kind} {{ … }} }}`"),
        })
}

/// `a: number = 3` among parameters.
pub(in crate::syntax) fn in_parameters(token: &str, span: Span) -> Diagnostic {
    unexpected(token, span)
        .at("a comma or `)` belongs before this")
        .help("each parameter is a name and a type: `a: length`")
}

/// `fn f(a: number): number`, `=>`; a sign without a space before it is followed by one.
pub(in crate::syntax) fn wrong_arrow(sign: &str, span: Span, touches: bool) -> Diagnostic {
    let arrow = if touches { " ->" } else { "->" };
    unexpected(sign, span).at("`->` is wanted").help(format!("write `{}`", form("fn"))).fix(span, arrow)
}

/// `fn f(a: number) number = a`
pub(in crate::syntax) fn missing_arrow(place: Span) -> Diagnostic {
    missing("`->` is missing before the type of the result", place, "fn")
        .at("`->` belongs here")
        .fix(place, " ->")
}

/// `fn f(a: number) -> number`
pub(in crate::syntax) fn missing_function_value(name: &str, place: Span) -> Diagnostic {
    missing(&format!("`fn {name}` has no value"), place, "fn").at("`=` and a value belong here")
}

/// `fn f() -> number { … }`, `fn f() -> number = { … }`
pub(in crate::syntax) fn function_braces(span: Span, behind_equals: bool) -> Diagnostic {
    unexpected("{", span)
        .at(if behind_equals { "one value belongs here" } else { "`=` is wanted" })
        .help("the body of a function is one value: `fn name(a: type) -> type = value`")
}

/// `assert c "message"`
pub(in crate::syntax) fn missing_comma(place: Span) -> Diagnostic {
    missing("a comma is missing before the message", place, "assert").at("`,` belongs here").fix(place, ",")
}

/// `@` alone.
pub(in crate::syntax) fn missing_mark(span: Span) -> Diagnostic {
    unexpected("@", span).at("a word belongs behind this").help("there are `@off`, `@solo` and `@allow(…)`")
}

/// `@allow W0106 "why"`; `place` is that of what belongs into parentheses.
pub(in crate::syntax) fn bare_arguments(code: &str, reason: &str, mark: Span, place: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, "what `@allow` takes stands in parentheses", place)
        .at("a warning, and the reason")
        .help(format!("write `@allow({code}, \"why\")`"))
        .fix(Span { start: mark.end, ..place }, format!("({code}, {reason})"))
}

/// `length r = 1m`
pub(in crate::syntax) fn type_before_name(ty: &Name, name: &Name) -> Diagnostic {
    let (word, declared, span) = (&ty.text, &name.text, ty.span.to(name.span));
    Diagnostic::new(Code::E0001, format!("`{declared}` is not declared by its type"), ty.span)
        .at("a type")
        .label(name.span, "what is declared")
        .help(format!("write `let {declared} = …`, or `param {declared}: {word} = …` for a setting"))
        .offer(format!("write `let {declared}`"), vec![(span, format!("let {declared}"))])
        .offer(format!("write `param {declared}: {word}`"), vec![(span, format!("param {declared}: {word}"))])
}

/// `@off` before nothing; `written` is the mark with what is in its parentheses.
pub(in crate::syntax) fn marks_nothing(mark: &Prefix, written: &str) -> Diagnostic {
    let word = format!("@{}", mark.name.text);
    let given: Vec<_> = mark.arguments.iter().flatten().map(|argument| &argument.value.kind).collect();
    let whole = match given[..] {
        _ if mark.name.text != "allow" => word.clone(),
        [ExprKind::Name(_), ExprKind::Text(_)] => written.to_string(),
        [ExprKind::Name(warning), ..] => format!("@allow({warning}, \"why\")"),
        _ => "@allow(W0106, \"why\")".to_string(),
    };
    Diagnostic::new(Code::E0001, format!("nothing follows `{word}`"), mark.span)
        .at("before what?")
        .help(format!("write it before a thing or a definition: `{whole} sphere {{ … }}`"))
}

/// `post left` in a group, where a part may be called `post`, and a field too; or `lens wide` in a camera, whose kind and that
/// of its part are given.
pub(in crate::syntax) fn thing_or_field(word: &Name, second: &Name, part: Option<[&str; 2]>) -> Diagnostic {
    let (word, second, span) = (&word.text, &second.text, word.span.to(second.span));
    let thing = match part {
        Some([whole, part]) => format!("`{part} {{ … }}` for the {part} of a {whole}"),
        None => format!("`{word} {second} {{ … }}` for a thing"),
    };
    Diagnostic::new(Code::E0001, format!("`{word} {second}` has no body"), span)
        .at("`{` is missing behind this, or `:` within")
        .help(format!("write {thing}, or `{word}: {second}` for a field"))
}

/// `@off radius: 1m`
pub(in crate::syntax) fn marks_field(mark: &str, field: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0001, format!("`{mark}` stands before a field"), span)
        .at("goes before a thing or a definition")
        .help(format!("move it before what has the field `{field}`, or delete it"))
}

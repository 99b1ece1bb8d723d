//! A document, and its layout: a group stands on one line if it fits there, else each of its line ends breaks
//! (after Wadler, A prettier printer, 2003).

/// A piece of a document.
pub(super) enum Doc<'t> {
    /// As it stands. It may have several lines where it is broken or a string.
    Text(&'t str),
    /// Set off by a space from what is before it. Behind `// …` the line ends.
    Comment(&'t str),
    /// A space, or a line end where the group is broken.
    Line,
    /// Nothing, or a line end where the group is broken.
    Soft,
    /// A line end. At the beginning of a line it does nothing, as the other line ends.
    Hard,
    /// A line end in the middle of an entry. What follows of that is [`hung`], or it would begin another one.
    Hang,
    /// A blank line before the line that follows, where the group is broken.
    Blank,
    /// A comma where the group is not broken.
    Comma,
    /// Two more columns of indentation.
    Nest(Vec<Doc<'t>>),
    /// On one line if it fits. With its width there, if it can stand there at all.
    Group(Vec<Doc<'t>>, Option<usize>),
}

/// A group of these pieces.
pub(super) fn group(docs: Vec<Doc>) -> Doc {
    let width = width_of(&docs);
    Doc::Group(docs, width)
}

/// The same with what stands behind the first [`Doc::Hang`] indented.
pub(super) fn hung(mut docs: Vec<Doc>) -> Vec<Doc> {
    if let Some(first) = docs.iter().position(Doc::hangs) {
        let rest = docs.split_off(first);
        docs.push(Doc::Nest(rest));
    }
    docs
}

impl Doc<'_> {
    /// Whether it is a [`Doc::Hang`].
    pub(super) fn hangs(&self) -> bool {
        matches!(self, Doc::Hang)
    }
}

fn width_of(docs: &[Doc]) -> Option<usize> {
    let (mut sum, mut spaced) = (0, false);
    for doc in docs {
        // A space that is there sets a comment off.
        sum += width(doc)? - usize::from(spaced && matches!(doc, Doc::Comment(_)));
        spaced = match doc {
            Doc::Line => true,
            Doc::Text(text) => text.ends_with(' '),
            Doc::Soft | Doc::Blank => spaced,
            _ => false,
        };
    }
    Some(sum)
}

fn width(doc: &Doc) -> Option<usize> {
    match doc {
        Doc::Text(text) => (!text.contains('\n')).then(|| text.chars().count()),
        Doc::Comment(text) => {
            let breaks = text.starts_with("//") || text.contains('\n');
            (!breaks).then(|| text.chars().count() + 1)
        }
        Doc::Line | Doc::Comma => Some(1),
        Doc::Soft | Doc::Blank => Some(0),
        Doc::Hard | Doc::Hang => None,
        Doc::Nest(docs) => width_of(docs),
        Doc::Group(_, width) => *width,
    }
}

/// The text of a document.
pub(super) fn render(docs: &[Doc], width: usize) -> String {
    let mut page =
        Page { out: String::new(), column: 0, indent: 0, at_start: true, ends: false, blank: false };
    let mut rest: Vec<Step> = docs.iter().rev().map(|doc| (doc, 0, true)).collect();
    while let Some((doc, indent, broken)) = rest.pop() {
        match doc {
            Doc::Text(text) => page.write(text, indent),
            Doc::Comment(text) => page.comment(text, indent),
            Doc::Line if broken => page.end_line(indent),
            Doc::Line => page.write(" ", indent),
            Doc::Soft if broken => page.end_line(indent),
            Doc::Hard | Doc::Hang => page.end_line(indent),
            Doc::Blank => page.blank |= broken,
            Doc::Comma if !broken => page.write(",", indent),
            Doc::Soft | Doc::Comma => {}
            Doc::Nest(docs) => rest.extend(docs.iter().rev().map(|doc| (doc, indent + 2, broken))),
            Doc::Group(docs, flat) => {
                let fits = !broken
                    || flat
                        .and_then(|flat| width.checked_sub(page.column_at(indent) + flat))
                        .is_some_and(|left| behind(&rest, left));
                rest.extend(docs.iter().rev().map(|doc| (doc, indent, !fits)));
            }
        }
    }
    page.end_line(0);
    page.out
}

/// A piece, its indentation, and whether its group is broken.
type Step<'d, 't> = (&'d Doc<'t>, usize, bool);

/// Whether what stands behind a group up to the next place where the line may end fits in so many columns.
fn behind(rest: &[Step], mut left: usize) -> bool {
    let mut stack: Vec<(&Doc, bool)> = vec![];
    let mut rest = rest.iter().rev();
    loop {
        let Some((doc, broken)) = stack.pop().or_else(|| rest.next().map(|(doc, _, broken)| (*doc, *broken)))
        else {
            return true;
        };
        let needed = match doc {
            Doc::Line | Doc::Soft if broken => return true,
            Doc::Hard | Doc::Hang => return true,
            Doc::Comment(text) if text.starts_with("//") => return true,
            Doc::Text(text) => text.lines().next().unwrap_or("").chars().count(),
            Doc::Comment(text) => 1 + text.lines().next().unwrap_or("").chars().count(),
            Doc::Comma | Doc::Line => usize::from(!broken),
            Doc::Soft | Doc::Blank => 0,
            Doc::Nest(docs) => {
                stack.extend(docs.iter().rev().map(|doc| (doc, broken)));
                0
            }
            // It may break itself.
            Doc::Group(docs, _) => {
                stack.extend(docs.iter().rev().map(|doc| (doc, true)));
                0
            }
        };
        match left.checked_sub(needed) {
            Some(less) => left = less,
            None => return false,
        }
    }
}

struct Page {
    out: String,
    /// Characters on this line, its indentation included.
    column: usize,
    /// Of this line, written with its first text.
    indent: usize,
    at_start: bool,
    /// Whether a comment stands last, behind which nothing can follow on its line.
    ends: bool,
    /// Whether a blank line is due.
    blank: bool,
}

impl Page {
    fn column_at(&self, indent: usize) -> usize {
        if self.at_start || self.ends { indent } else { self.column }
    }

    fn write(&mut self, text: &str, indent: usize) {
        if self.ends {
            self.end_line(indent);
        }
        let text = if self.at_start { text.trim_start_matches(' ') } else { text };
        if self.at_start && !text.is_empty() {
            self.out.extend(std::iter::repeat_n(' ', self.indent));
            (self.at_start, self.column) = (false, self.indent);
        }
        self.out.push_str(text);
        match text.rfind('\n') {
            Some(newline) => self.column = text[newline + 1..].chars().count(),
            None => self.column += text.chars().count(),
        }
    }

    fn comment(&mut self, text: &str, indent: usize) {
        if !self.at_start && !self.ends && !self.out.ends_with(' ') {
            self.write(" ", indent);
        }
        self.write(text.trim_ascii_end(), indent);
        self.ends = text.starts_with("//");
    }

    fn end_line(&mut self, indent: usize) {
        if !self.at_start {
            self.out.truncate(self.out.trim_end_matches(' ').len());
            self.out.push('\n');
        }
        if std::mem::take(&mut self.blank) && !self.out.is_empty() && !self.out.ends_with("\n\n") {
            self.out.push('\n');
        }
        (self.at_start, self.ends, self.column, self.indent) = (true, false, indent, indent);
    }
}

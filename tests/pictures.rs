//! Small pictures, exact to the bit: `cases/pictures/*.rt`, and the examples at a stamp's size.
//!
//! They are compared decoded. Where one differs, `target/pictures` gets what was expected, what came, and the
//! difference, 16 times enlarged. `INSTA_UPDATE=always` accepts what came; look at it before.

use insta::internals::{Content, SnapshotContents};
use insta::{Comparator, Snapshot};
use rt_lang::lower::Overrides;
use rt_lang::output::{Depth, Facts, Format, Picture, encode};
use rt_lang::render::{Control, Shown, Tracer, Window};
use rt_lang::source::{Source, Sources};
use std::path::{Path, PathBuf};

#[test]
fn pictures_are_the_same_to_the_bit() {
    check("cases/pictures/*.rt", "cases/pictures", &Overrides::default());
}

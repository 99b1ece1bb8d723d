//! A scene-description language and its renderer.
//!
//! The library is pure: text in, values out. The binary `rtc` does all input and output. Data flows one way:
//!
//! ```text
//! text ──syntax──▶ tree ──check──▶ program ──eval──▶ things ──lower──▶ scene ──render──▶ film ──output──▶ bytes
//! ```
//!
//! The modules, in reading order. Each may use only those that `tests/architecture.rs` lists for it.
//!
//! | module | what it holds | what it does not know |
//! |---|---|---|
//! | [`span`], [`source`], [`diagnostic`] | places, texts, what is said of them | terminals |
//! | [`math`], [`color`], [`units`], [`develop`] | arithmetic with the same bits everywhere | the language |
//! | [`schema`] | the one table of kinds and fields | how they are checked or drawn |
//! | [`syntax`] | text to tree; never fails | names, types, the scene |
//! | [`check`] | tree to typed program: names, types, units | values |
//! | [`eval`] | program to things, each with the chain of uses that made it | the renderer |
//! | [`lower`] | things to scene: defaults, cameras, transforms, radiometry | text |
//! | [`scene`] | the picture in its simplest form | where it came from |
//! | [`render`] | scene to film; cannot fail | places, files, syntax |
//! | [`output`] | film to the bytes of image files, and back | files |
//! | [`report`] | diagnostics to text for a person | what they are about |

pub mod color;
pub mod develop;
pub mod diagnostic;
pub mod math;
pub mod scene;
pub mod schema;
pub mod source;
pub mod span;
pub mod syntax;
pub mod units;

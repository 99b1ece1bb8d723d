//! Where something can be done with the picture.

use super::{Analysis, Lens, LensAction};
use crate::check::{Kind, Making, Meaning, Type};
use crate::schema::camera;
use crate::span::Span;
use crate::syntax::ast::{Entry, StatementKind};

/// Above each camera, and above the file where it has none: it is shown, and made, as it stands there.
pub(super) fn lenses(analysis: &Analysis) -> Vec<Lens> {
    let mut places: Vec<(Span, Option<String>)> = vec![];
    let notes = &analysis.study.notes;
    let file = analysis.study.files.iter().find(|file| file.source == analysis.main);
    for entry in file.iter().flat_map(|file| &file.tree.body.entries) {
        let Entry::Statement(statement) = entry else { continue };
        let StatementKind::Thing { name, construct } = &statement.kind else { continue };
        let is_camera = match notes.meaning(construct.kind.first.span) {
            Some(Meaning::Kind(kind)) => kind == camera::KIND,
            Some(Meaning::Declared(place)) => {
                let made = notes.declared(place);
                matches!(made, Some(Type::Made(Making { kind: Kind::BuiltIn(kind), .. })) if *kind == camera::KIND)
            }
            _ => false,
        };
        if is_camera {
            places.push((super::walk::whole(statement), name.as_ref().map(|name| name.text.to_string())));
        }
    }
    if places.is_empty() {
        places.push((Span::new(analysis.main, 0, 0), None));
    }
    let both = [LensAction::Preview, LensAction::Render];
    let lens = |(span, camera): (Span, Option<String>)| {
        both.map(|action| Lens { span, action, camera: camera.clone() })
    };
    places.into_iter().flat_map(lens).collect()
}

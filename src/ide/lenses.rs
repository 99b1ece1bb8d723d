//! Where something can be done with the picture.

use super::{Analysis, Lens, LensAction};
use crate::schema::camera;
use crate::span::Span;
use crate::syntax::ast::{Entry, StatementKind};

/// Above each camera, and above the file where it has none: it is shown, and made, as it stands there.
pub(super) fn lenses(analysis: &Analysis) -> Vec<Lens> {
    let mut places: Vec<(Span, Option<String>)> = vec![];
    let file = analysis.study.files.iter().find(|file| file.source == analysis.main);
    for entry in file.iter().flat_map(|file| &file.tree.body.entries) {
        let Entry::Statement(statement) = entry else { continue };
        let StatementKind::Thing { name, construct } = &statement.kind else { continue };
        if analysis.kind_of(&construct.kind) == Some(camera::KIND) {
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

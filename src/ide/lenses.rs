//! Where something can be done with the picture.

use super::{Analysis, Lens, LensAction, walk};
use crate::schema::camera;
use crate::span::Span;
use crate::syntax::ast::{Entry, StatementKind};

/// Above each camera that can be asked for, and above the file where it has none: it is shown, and made, as it stands there.
pub(super) fn lenses(analysis: &Analysis) -> Vec<Lens> {
    let file = analysis.study.files.iter().find(|file| file.source == analysis.main);
    let cameras = file.iter().flat_map(|file| &file.tree.body.entries).filter_map(|entry| {
        let Entry::Statement(statement) = entry else { return None };
        let StatementKind::Thing { name, construct } = &statement.kind else { return None };
        let is_on = statement.prefixes.iter().all(|prefix| prefix.name.text != "off");
        let is_camera = analysis.kind_of(&construct.kind) == Some(camera::KIND);
        (is_on && is_camera)
            .then(|| (walk::whole(statement), name.as_ref().map(|name| name.text.to_string())))
    });
    let cameras: Vec<(Span, Option<String>)> = cameras.collect();
    // One without a name is the scene's where there is no other.
    let is_alone = cameras.len() == 1 && analysis.cameras().is_none_or(<[String]>::is_empty);
    let mut places: Vec<_> = cameras.into_iter().filter(|(_, name)| name.is_some() || is_alone).collect();
    if places.is_empty() {
        places.push((Span::new(analysis.main, 0, 0), None));
    }
    let both = [LensAction::Preview, LensAction::Render];
    let lens = |(span, camera): (Span, Option<String>)| {
        both.map(|action| Lens { span, action, camera: camera.clone() })
    };
    places.into_iter().flat_map(lens).collect()
}

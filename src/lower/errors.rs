//! One function for each thing that can be wrong with a picture as a whole.

use super::MAX_PIXELS;
use crate::diagnostic::{Code, Diagnostic};
use crate::schema::camera;
use crate::span::{SourceId, Span};

/// The beginning of the file, for what is missing from all of it.
fn start() -> Span {
    Span::new(SourceId(0), 0, 0)
}

pub(super) fn nothing_stands(main: SourceId) -> Diagnostic {
    Diagnostic::new(Code::E0302, "nothing stands in this scene", Span::new(main, 0, 0))
        .at("no shape and no light")
        .help("a thing in the picture is a statement of its own: `sphere { radius: 1m }`")
}

pub(super) fn second(kind: &str, span: Span, first: Span) -> Diagnostic {
    Diagnostic::new(Code::E0303, format!("a second `{kind}`"), span)
        .at("again here")
        .label(first, "the first")
        .help("a picture has one; put the fields of both together")
}

pub(super) fn not_finite_place(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0407, "the placements of this thing leave the numbers", span)
        .at("nowhere to be drawn")
}

pub(super) fn too_large(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0407, "this shape is too large to be computed with", span).at("not finite")
}

pub(super) fn beyond_view(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0407, "what the camera is to look at reaches too far to be computed with", span)
        .at("not finite")
        .help("bring the things nearer, or give the camera `from` and `look`")
}

pub(super) fn too_wide(focal: Span) -> Diagnostic {
    let field = camera::KIND.field(camera::FOV.index(camera::KIND));
    let widest = (field.range.high * 180.0 / std::f64::consts::PI).round();
    let message = format!("this lens sees more than `{}: {widest}deg`, the widest view there is", field.name);
    Diagnostic::new(Code::E0401, message, focal)
        .at("too short for the sensor")
        .help("give a longer `focal` or a smaller `sensor`")
}

pub(super) fn glows_beyond(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0407, "the radiance of this light is too large to be held", span)
        .at("not finite")
        .help("give it less power, or a larger surface")
}

pub(super) fn no_direction(field: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0403, format!("`{field}` has length 0, and so no direction"), span)
        .at("points nowhere")
        .help("such as `(0, 1, 0)` for upwards")
}

pub(super) fn flattened(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0403, "this shape is flattened to nothing", span)
        .at("has no extent left")
        .help("a `matrix` of vectors in one plane, or sizes too small or too far apart, leave no solid")
}

pub(super) fn height_between_sheets(least: f64, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0403, "nothing is left of this hyperboloid", span)
        .at("ends before the sheets begin")
        .help(format!(
            "the sheets begin at |y| = b, so `height` must be above 2b = {least}m; or use `sheets: 1`"
        ))
}

pub(super) fn endless_power(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0304, "`power` cannot be spread over an endless surface", span)
        .at("over an infinite area")
        .help("give `radiance: 1W/m2` in its place, or the shape an end")
}

pub(super) fn textured_power(span: Span, color: Span) -> Diagnostic {
    Diagnostic::new(Code::E0304, "`power` does not go with a texture", span)
        .at("spread how?")
        .label(color, "a texture")
        .help("how much a texture leaves of it is not known: give `radiance: 1W/m2` in its place")
}

pub(super) fn no_picture(written: &str, why: &str, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0501, format!("`{written}` {why}"), span)
        .at("not usable as a picture")
        .help("a picture is an opaque PNG, JPEG, WebP, HDR or EXR")
}

pub(super) fn no_mesh(written: &str, why: &str, span: Span) -> Diagnostic {
    let help = match written.ends_with(".rt") {
        true => "a mesh is a PLY or OBJ file with faces; a scene is taken in by `import \"file.rt\" as name`",
        false => "a mesh is a PLY or OBJ file with faces",
    };
    Diagnostic::new(Code::E0501, format!("`{written}` {why}"), span).at("not usable as a mesh").help(help)
}

pub(super) fn too_many_triangles(most: usize, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0406, format!("the meshes have more than {most} triangles together"), span)
        .at("one too many")
        .help("simplify the mesh; copies of one file count once")
}

pub(super) fn too_many_texels(most: u64, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0406, format!("the pictures have more than {most} pixels together"), span)
        .at("one too many")
        .help("store pictures smaller")
}

pub(super) fn too_bright(written: &str, peak: f64, span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0402, format!("`{written}` reflects more than it receives"), span)
        .at(format!("a channel of {peak}"))
        .help("no channel of a reflectance is above 1: store it darker, or as a PNG")
}

pub(super) fn stretched_sky(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0403, "the groups around this sky stretch it", span)
        .at("can only be turned")
        .help("a picture of all directions has no size; leave it outside of groups that `scale` unevenly")
}

pub(super) fn lens_of_which(lens: Span, camera: Span) -> Diagnostic {
    Diagnostic::new(Code::E0304, "a lens beside several cameras belongs to none of them", lens)
        .at("whose lens?")
        .label(camera, "a camera")
        .help("put it into the camera: `camera { …, lens { … } }`")
}

pub(super) fn no_such_camera(wanted: &str, names: &[&str], place: Option<Span>) -> Diagnostic {
    let diagnostic =
        Diagnostic::new(Code::E0101, format!("no camera is called `{wanted}`"), place.unwrap_or_else(start));
    match names {
        [] => diagnostic.help("name one: `camera wide { … }`"),
        names => diagnostic.help(format!("there is `--camera {}`", names.join("`, `--camera "))),
    }
}

pub(super) fn which_camera(span: Span, first: Span, names: &[&str]) -> Diagnostic {
    let help = match names.first() {
        Some(name) => format!("choose with `render {{ camera: {name} }}`, or with `--camera {name}`"),
        None => "name them, as in `camera wide { … }`, and choose with `render { camera: wide }`".to_string(),
    };
    Diagnostic::new(Code::E0302, "several cameras, and none is chosen", span)
        .at("another camera")
        .label(first, "a camera")
        .help(help)
}

pub(super) fn too_many_pixels(size: [u32; 2], span: Option<Span>) -> Diagnostic {
    let message =
        format!("{} × {} pixels are more than {} million", size[0], size[1], MAX_PIXELS / 1_000_000);
    Diagnostic::new(Code::E0406, message, span.unwrap_or_else(start)).at("too large a picture")
}

pub(super) fn looks_at_itself(from: Span, look: Option<Span>) -> Diagnostic {
    let diagnostic = |message| Diagnostic::new(Code::E0404, message, from).at("stands here");
    match look {
        Some(look) => diagnostic("the camera looks at the point where it stands")
            .help("move `from` away from `look`")
            .label(look, "looks here"),
        None => diagnostic("the camera stands in the middle of the scene, and nothing says where it looks")
            .help("say it with `look`, or move `from` away from the middle"),
    }
}

pub(super) fn up_along_view(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0404, "`up` points along the view, so nothing says what is upright", span)
        .at("along the view, or of length 0")
        .help("choose another direction, such as `(0, 0, -1)` for a view from above")
}

pub(super) fn no_middle(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0305, "this thing has no bounds, and so no middle", span)
        .at("endless, empty or in no place")
        .help("name a thing with bounds, or give a point: `(0, 1, 0)m`")
}

pub(super) fn focus_behind(span: Span) -> Diagnostic {
    Diagnostic::new(Code::E0401, "the plane of focus lies behind the camera", span)
        .at("not in front")
        .help("focus on what the camera looks at")
}

pub(super) fn lens_of_parallel(lens: Span, width: Span) -> Diagnostic {
    Diagnostic::new(Code::E0304, "an orthographic camera has no lens", lens)
        .at("a lens")
        .label(width, "which makes the camera orthographic")
        .help("give `fov` in place of `width`, or leave the lens out")
}

pub(super) fn aimed_at_itself(aim: Span) -> Diagnostic {
    Diagnostic::new(Code::E0404, "the spot is aimed at the point where it stands", aim)
        .at("no direction")
        .help("move the light away from what it shines at")
}

pub(super) fn fov_and_focal(fov: Span, focal: Span) -> Diagnostic {
    Diagnostic::new(Code::E0304, "`fov` and `focal` both say how wide the view is", fov)
        .at("one of the two")
        .label(focal, "the other")
        .help("keep one of them; `lens { aperture: 5mm }` blurs and leaves the view to `fov`")
}

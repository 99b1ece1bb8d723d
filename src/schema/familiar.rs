//! What other tools call the fields, kinds and functions that have another name here: for hints beyond spelling.

use super::Category;

/// What a name from elsewhere means here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Familiar {
    /// The name that it has here, if it is one field, kind or function.
    pub name: Option<&'static str>,
    /// Whether the value can stay as it is, so that the name alone is replaced.
    pub same_value: bool,
    /// One sentence without a full stop.
    pub hint: &'static str,
}

const fn renamed(name: &'static str, hint: &'static str) -> Familiar {
    Familiar { name: Some(name), same_value: true, hint }
}

const fn rewritten(name: &'static str, hint: &'static str) -> Familiar {
    Familiar { name: Some(name), same_value: false, hint }
}

const fn elsewhere(hint: &'static str) -> Familiar {
    Familiar { name: None, same_value: false, hint }
}

/// What a field that a kind does not have is called here.
pub fn field(kind: &str, category: Category, name: &str) -> Option<Familiar> {
    match category {
        Category::Shape | Category::Group => {
            drawn(name).or_else(|| placed(kind, name)).or_else(|| shape(kind, name))
        }
        Category::Material => material(kind, name),
        Category::Light => drawn(name).or_else(|| light(kind, name)),
        Category::Block => block(kind, name),
    }
}

fn drawn(name: &str) -> Option<Familiar> {
    match name {
        "off" | "visible" | "hidden" | "hide" | "enabled" | "disabled" | "visibility" => {
            Some(elsewhere("`@off` before a thing leaves it out of the picture: `@off sphere { … }`"))
        }
        _ => None,
    }
}

fn placed(kind: &str, name: &str) -> Option<Familiar> {
    const MIDDLE: [&str; 2] = ["center", "centre"];
    Some(match name {
        "position" | "pos" | "location" | "origin" | "center" | "centre" => match kind {
            "cylinder" | "cone" | "paraboloid" => rewritten(
                "at",
                "it stands on `at`, so that its middle is half of its `height` above that: `at: (0, 1, 0)m`",
            ),
            // Their origin is the middle, or as good as that.
            "sphere" | "disk" | "box" | "hyperboloid" | "plane" => renamed("at", "`at` says where it stands"),
            _ if MIDDLE.contains(&name) => {
                rewritten("at", "`at` says where its origin stands, which need not be its middle")
            }
            _ => renamed("at", "`at` says where its origin stands"),
        },
        "translate" | "translation" | "rotate" | "rotation" | "scale" | "transform" | "orientation"
        | "matrix" => rewritten(
            "place",
            "`place` scales, turns and moves: `place: scale(2) |> turn(y: 30deg) |> move(0, 1m, 0)`",
        ),
        "color" | "colour" | "albedo" | "pigment" => {
            rewritten("material", "a colour belongs to a material: `material: diffuse { color: #d94f30 }`")
        }
        "texture" | "finish" | "shader" | "bsdf" | "surface" | "interior" => rewritten(
            "material",
            "`material` says what it is made of: `material: diffuse { color: #d94f30 }`",
        ),
        "emission" | "emissive" => {
            rewritten("material", "what glows has an `emitter`: `material: emitter { power: 5W }`")
        }
        _ => return None,
    })
}

fn shape(kind: &str, name: &str) -> Option<Familiar> {
    Some(match (kind, name) {
        ("sphere" | "disk" | "cylinder" | "cone" | "paraboloid", "r" | "rad") => {
            renamed("radius", "the radius is called `radius`")
        }
        ("cylinder" | "cone" | "paraboloid", "h" | "length") => {
            renamed("height", "`height` is along its axis")
        }
        ("sphere", "size")
        | (
            "sphere" | "disk" | "cylinder" | "cone" | "paraboloid",
            "d" | "diameter" | "diametre" | "diam" | "width",
        ) => rewritten("radius", "`radius` is half of the diameter"),
        ("box", "min" | "max" | "from" | "to" | "corner" | "corner1" | "corner2") => {
            rewritten("size", "a box stands around `at` with its `size`: `at: (0, 1, 0)m, size: (2, 2, 2)m`")
        }
        ("cylinder", "top" | "top_radius" | "radius_top" | "radius1" | "radius2" | "taper") => elsewhere(
            "a `cylinder` is as wide at both ends: what is not is a `cone`, with its `top`: \
             `cone { radius: 20cm, top: 10cm, height: 50cm }`",
        ),
        ("cylinder" | "cone" | "paraboloid", "from" | "to" | "start" | "end" | "base" | "top" | "cap") => {
            rewritten(
                "height",
                "it stands upright around `at` with its `height`, and `place` turns it: `place: turn(z: 30deg)`",
            )
        }
        ("box", "width" | "height" | "depth" | "dimensions" | "extent" | "extents") => {
            rewritten("size", "`size` is width, height and depth together: `size: (1, 2, 3)m`")
        }
        ("plane" | "disk", "up" | "direction" | "axis") => {
            renamed("normal", "`normal` is the way that it faces")
        }
        ("plane", "distance" | "offset") => rewritten("at", "`at` is a point that it goes through"),
        ("mesh", "path" | "src" | "source" | "filename") => renamed("file", "`file` names the mesh"),
        _ => return None,
    })
}

fn material(kind: &str, name: &str) -> Option<Familiar> {
    Some(match (kind, name) {
        ("dielectric", "index" | "eta" | "refractive_index" | "index_of_refraction") => {
            renamed("ior", "`ior` is the refractive index")
        }
        ("dielectric", "refraction") => rewritten("ior", "`ior` is the refractive index"),
        ("plastic", "index" | "eta" | "refractive_index" | "index_of_refraction") => {
            renamed("ior", "`ior` is the refractive index of the coat")
        }
        (
            "dielectric",
            "color" | "colour" | "albedo" | "base_color" | "transmission" | "absorption" | "transmittance",
        ) => rewritten("tint", "`tint` is the colour that white light has after travelling `depth` inside"),
        ("emitter", "intensity" | "strength" | "brightness" | "emission" | "energy") => {
            rewritten("radiance", "say how much it gives with `power: 5W` in all, or with `radiance: 2W/m2`")
        }
        ("diffuse" | "mirror" | "metal" | "plastic", "colour" | "albedo" | "reflectance" | "base_color")
        | ("diffuse" | "plastic", "kd") => renamed("color", "`color` is the reflectance"),
        ("diffuse" | "mirror" | "metal" | "plastic" | "emitter", "texture" | "map" | "pattern") => {
            rewritten("color", "a texture is given as the `color`: `color: checker(red, white, 10cm)`")
        }
        (
            "metal" | "plastic" | "dielectric",
            "glossiness" | "shininess" | "smoothness" | "fuzz" | "alpha",
        ) => rewritten("roughness", "`roughness` is 0 for polished and 1 for matt"),
        _ => return None,
    })
}

fn light(kind: &str, name: &str) -> Option<Familiar> {
    const MUCH: [&str; 14] = [
        "intensity",
        "strength",
        "energy",
        "brightness",
        "emission",
        "flux",
        "watts",
        "wattage",
        "luminosity",
        "lumens",
        "lumen",
        "lm",
        "candela",
        "lux",
    ];
    let much = MUCH.contains(&name);
    Some(match (kind, name) {
        ("light", "position" | "pos" | "location" | "center" | "centre" | "from" | "origin") => {
            renamed("at", "`at` says where it stands")
        }
        ("light", _) if much => rewritten("power", "`power` is what it radiates in all: `power: 60W`"),
        // What is said of these takes other fields along, or another value.
        ("light", "target" | "point_at" | "look_at" | "look" | "direction" | "dir") => {
            elsewhere("`aim` is what a spot shines at: `aim: (0, 1, 0)m, cone: 40deg`")
        }
        ("light", "angle" | "spot_size" | "cutoff") => elsewhere(
            "`cone` is the full angle of a spot, beside what it shines at: `aim: (0, 1, 0)m, cone: 40deg`",
        ),
        ("light", "blend" | "penumbra") => {
            elsewhere("`soft` is the share of a spot's `cone` over which its light fades")
        }
        ("sky", "rotation" | "rotate" | "angle") => {
            elsewhere("`turn` turns the `image` of a sky about the y axis: `turn: 90deg`")
        }
        ("light", "size") => rewritten("radius", "`radius` makes it a glowing ball, with soft shadows"),
        ("sun", "direction" | "dir" | "to" | "position") => {
            rewritten("from", "`from` points towards the sun, against the way its light goes")
        }
        ("sun", "power") => {
            rewritten("irradiance", "`irradiance` is what falls on a surface that faces it: `3W/m2`")
        }
        ("sun", _) if much => {
            rewritten("irradiance", "`irradiance` is what falls on a surface that faces it: `3W/m2`")
        }
        ("sun", "size" | "diameter") => renamed("angle", "`angle` is its apparent diameter"),
        ("sky", "power") => rewritten("radiance", "`radiance` is what every direction gives: `1W/m2`"),
        ("sky", _) if much => rewritten("radiance", "`radiance` is what every direction gives: `1W/m2`"),
        ("sky", "map" | "hdri" | "texture" | "file" | "environment") => {
            renamed("image", "`image` names the picture")
        }
        (_, "colour") => renamed("color", "`color` is its colour"),
        _ => return None,
    })
}

fn block(kind: &str, name: &str) -> Option<Familiar> {
    Some(match (kind, name) {
        ("camera", "position" | "pos" | "location" | "eye" | "origin") => {
            renamed("from", "`from` says where the camera stands")
        }
        ("camera", "center" | "centre" | "at") => {
            rewritten("from", "`from` says where the camera stands, and `look` what it looks at")
        }
        ("camera", "look_at" | "lookat" | "lookAt" | "target" | "to" | "aim") => {
            renamed("look", "`look` says what is in the middle of the picture")
        }
        ("camera", "fovx" | "fov_x" | "xfov" | "hfov" | "horizontal_fov") => {
            renamed("fov", "`fov` is the view across the width")
        }
        ("camera", "vfov" | "fovy" | "fov_y" | "yfov" | "vertical_fov") => rewritten(
            "fov",
            "`fov` is the angle across the width: of a picture that is not square another one than up its height",
        ),
        ("camera", "angle" | "field_of_view" | "view_angle") => {
            rewritten("fov", "`fov` is the angle across the width")
        }
        (
            "camera",
            "aperture" | "focal" | "focal_length" | "stop" | "fstop" | "f_stop" | "focus" | "focus_distance",
        ) => rewritten("lens", "it belongs to the lens: `lens { focal: 50mm, stop: 2.8 }`"),
        ("camera", "resolution" | "size") => {
            elsewhere("the size belongs to the picture: `render { size: (1280, 720) }`")
        }
        ("lens", "f") => {
            elsewhere("`focal` is the focal length, `stop` the f-number: `focal: 50mm, stop: 2.8`")
        }
        ("lens", "radius" | "lens_radius") => {
            rewritten("aperture", "`aperture` is the diameter of the opening, twice its radius")
        }
        ("lens", "diameter") => renamed("aperture", "`aperture` is the diameter of the opening"),
        ("lens", "focal_length") => renamed("focal", "`focal` is the focal length"),
        ("lens", "f_stop" | "fstop" | "f_number") => renamed("stop", "`stop` is the f-number"),
        ("lens", "focus_distance") => renamed("focus", "`focus` is where it is sharp"),
        ("lens", "focal_distance") => {
            rewritten("focus", "`focus` is where it is sharp, `focal` the focal length")
        }
        ("render", "resolution" | "res" | "dimensions") => {
            renamed("size", "`size` is width and height in pixels")
        }
        ("render", "width" | "height") => {
            rewritten("size", "`size` is width and height together: `size: (1280, 720)`")
        }
        ("render", "spp" | "sample_count" | "samples_per_pixel") => {
            renamed("samples", "`samples` are those of a pixel")
        }
        ("render", "depth" | "max_depth" | "maxdepth" | "max_bounces" | "recursion") => {
            rewritten("bounces", "`bounces` limits how often light is scattered: 1 is direct light alone")
        }
        ("render", "output" | "file" | "filename") => {
            elsewhere("the command says where to: `rtc build scene.rt -o picture.png`")
        }
        ("render", "denoise" | "denoiser" | "denoising") => {
            elsewhere("the command does that: `rtc build scene.rt --denoise`")
        }
        ("render", "threads") => elsewhere("the command says how many: `rtc build scene.rt -j 4`"),
        ("render", "exposure") => elsewhere("`exposure` belongs to the camera"),
        ("render", "background") => {
            elsewhere("what is behind everything is the sky: `sky { color: #203040 }`")
        }
        _ => return None,
    })
}

/// What a bare number may mean where a field wants a quantity.
pub fn number(field: &str) -> Option<&'static str> {
    match field {
        "aperture" => Some(
            "an f-number is the `stop` of a lens, `focal: 50mm, stop: 2.8`; an `aperture` is a diameter, \
             such as `2.8mm`",
        ),
        _ => None,
    }
}

/// What a kind that there is not is called here.
pub fn kind(name: &str) -> Option<Familiar> {
    Some(match name {
        "ball" => renamed("sphere", "a ball is a `sphere`"),
        "cube" | "cuboid" | "brick" => rewritten("box", "a box is a `box`, with its `size`"),
        "disc" => renamed("disk", "a disc is a `disk`"),
        "ground" | "floor" => rewritten("plane", "an endless floor is a `plane`"),
        "point_light" | "pointlight" | "light_source" | "lamp" | "omni" => {
            renamed("light", "a lamp is a `light`")
        }
        "spot" | "spotlight" | "spot_light" => {
            rewritten("light", "a spot is a `light` with `aim` and `cone`")
        }
        "area_light" | "arealight" => rewritten(
            "light",
            "a light with a `radius` glows as a ball; any shape glows with an `emitter` as its material",
        ),
        "directional" | "directional_light" | "sunlight" | "distant" => {
            rewritten("sun", "light from far away is a `sun`: `sun { from: (1, 2, 1), irradiance: 3W/m2 }`")
        }
        "background" | "environment" | "env" | "sky_sphere" | "hdri" => {
            rewritten("sky", "what is behind everything is the `sky`: `sky { color: #203040 }`")
        }
        "glass" => renamed("dielectric", "glass is a `dielectric`"),
        "water" => rewritten("dielectric", "water is a `dielectric`: `dielectric { ior: 1.33 }`"),
        "lambertian" | "lambert" | "matte" => renamed("diffuse", "a matt surface is `diffuse`"),
        "specular" => rewritten("mirror", "a perfect mirror is a `mirror`"),
        "conductor" => renamed("metal", "a conductor is a `metal`"),
        "emissive" | "emission" | "area" | "diffuse_light" => {
            rewritten("emitter", "what glows is an `emitter`")
        }
        "settings" | "image" | "film" | "output" | "global_settings" => {
            rewritten("render", "how the picture is made stands in `render`: `render { size: (1280, 720) }`")
        }
        "texture" | "pigment" | "finish" | "interior" => rewritten(
            "diffuse",
            "what a shape is made of is a material: `material: diffuse { color: #d94f30 }`",
        ),
        "triangle" | "polygon" | "smooth_triangle" | "quad" | "mesh2" => {
            rewritten("mesh", "triangles come from a file: `mesh { file: \"shape.obj\" }`")
        }
        "torus" | "text" | "blob" | "prism" | "lathe" => {
            rewritten("mesh", "there is no such shape; as triangles it is a `mesh { file: \"shape.obj\" }`")
        }
        "difference" | "intersection" | "csg" => {
            elsewhere("shapes are not cut out of each other; a `mesh` from a file may have any shape")
        }
        "union" | "merge" | "object" | "node" | "scene" | "world" => {
            rewritten("group", "things are put together in a `group`")
        }
        _ => return None,
    })
}

/// What a function that there is not is called here, or how one does without it.
pub fn function(name: &str) -> Option<Familiar> {
    Some(match name {
        "ln" => renamed("log", "`log` is the natural logarithm"),
        "log2" => elsewhere("`log` is the natural logarithm, that to the base 2 is `log(x) / log(2)`"),
        "log10" | "lg" => {
            elsewhere("`log` is the natural logarithm, that to the base 10 is `log(x) / log(10)`")
        }
        "exp2" => elsewhere("2 to a power is `pow(2, x)`"),
        "sqr" | "square" => elsewhere("a square is written `x * x`"),
        "cbrt" => elsewhere("a cube root is `pow(x, 1 / 3)`"),
        "power" => rewritten("pow", "`pow(a, b)` is a to the power b"),
        "hypot" => elsewhere("write `sqrt(a * a + b * b)`; the length of a triple is `length(v)`"),
        "sign" | "sgn" | "signum" => elsewhere("choose by what it is: `if x < 0 then -1 else 1`"),
        "sinh" => elsewhere("write `(exp(x) - exp(-x)) / 2`"),
        "cosh" => elsewhere("write `(exp(x) + exp(-x)) / 2`"),
        "tanh" => elsewhere("write `1 - 2 / (exp(2 * x) + 1)`"),
        "asinh" | "arsinh" => elsewhere("write `log(x + sqrt(x * x + 1))`"),
        "acosh" | "arcosh" => elsewhere("write `log(x + sqrt(x * x - 1))`"),
        "atanh" | "artanh" => elsewhere("write `log((1 + x) / (1 - x)) / 2`"),
        "atan" | "arctan" => elsewhere("the angle of a slope is `atan2(y, x)`"),
        "radians" | "to_radians" | "deg2rad" | "degtorad" => {
            elsewhere("an angle has its unit: `90deg`, and is wanted as such by `sin` and `turn`")
        }
        "degrees" | "to_degrees" | "rad2deg" | "radtodeg" => {
            elsewhere("an angle has its unit: `1.5rad`; how many degrees it is, is `angle / 1deg`")
        }
        "trunc" | "truncate" | "int" | "integer" => {
            elsewhere("`floor(x)` is the next whole number below, `ceil(x)` above, `round(x)` the nearest")
        }
        "fract" | "frac" => elsewhere("what is behind the point is `mod(x, 1)`"),
        "fmod" | "modulo" | "rem" => rewritten("mod", "`mod(a, b)` is the remainder, with the sign of b"),
        "step" => elsewhere("choose by what it is: `if x < edge then 0 else 1`"),
        "smoothstep" => elsewhere("with a `t` from 0 to 1 write `t * t * (3 - 2 * t)`"),
        "saturate" => elsewhere("write `clamp(x, 0, 1)`"),
        "lerp" | "interpolate" => rewritten("mix", "`mix(a, b, t)` lies between two values"),
        "norm" | "magnitude" | "vlength" => rewritten("length", "`length(v)` is how long a triple is"),
        "distance" | "dist" => elsewhere("how far two points are apart is `length(a - b)`"),
        "normalise" | "normalized" | "normalised" | "unit_vector" | "vnormalize" => {
            rewritten("normalize", "`normalize(v)` has the same direction, and the length 1")
        }
        "vdot" | "dot_product" => rewritten("dot", "`dot(a, b)` is the scalar product"),
        "vcross" | "cross_product" => rewritten("cross", "`cross(a, b)` is the vector product"),
        "len" | "size" | "count" => rewritten("length", "`length(list)` is how many items it has"),
        "random" | "rnd" => elsewhere(
            "`rand(i, j)` looks random, and is always the same for the same numbers, such as those of a loop",
        ),
        "rotate" => rewritten("turn", "`turn` turns about one axis: `turn(y: 30deg)`"),
        "translate" => rewritten("move", "`move` moves: `move(0, 1m, 0)`"),
        "vec3" | "vec" | "vector" | "Vector" | "point" | "float3" | "xyz" => {
            elsewhere("three values stand in parentheses: `(0, 1, 0)m`")
        }
        "rgba" | "srgba" | "rgbf" | "rgbt" => elsewhere(
            "a colour has no transparency: `srgb(r, g, b)`, each from 0 to 1; what one sees through is a `dielectric`",
        ),
        "hsl" | "hsla" => elsewhere(
            "`hsv(angle, s, v)` is another way to say a colour, with a value in place of a lightness",
        ),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::{self, KindId};

    /// Every name that a hint leads to exists, and no hint hides a field that there is.
    #[test]
    fn hints_lead_to_what_there_is() {
        let words: Vec<&str> =
            include_str!("familiar.rs").split('"').filter(|word| word.len() < 30).collect();
        for index in 0..schema::KINDS.len() {
            let id = KindId(index as u8);
            for word in &words {
                let Some(found) = field(id.get().name, id.get().category, word) else { continue };
                if id.field_index(word).is_none()
                    && let Some(name) = found.name
                {
                    assert!(id.field_index(name).is_some(), "{}: {word} leads to {name}", id.get().name);
                }
            }
        }
        for word in &words {
            if let Some(name) = kind(word).and_then(|found| found.name) {
                assert!(
                    schema::kind(name).is_some() || ["box", "disk"].contains(&name),
                    "{word} leads to {name}"
                );
            }
        }
    }
}

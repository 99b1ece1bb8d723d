//! The one table of kinds and their fields: types, units, defaults, ranges and documentation.
//!
//! Checking, lowering, messages and the reference page all read it, and no field is named anywhere else: the
//! `kinds!` table also yields a module a kind (`sphere::RADIUS`, …) with a typed key a field.

pub mod familiar;
pub mod textures;
mod types;
mod values;

use std::marker::PhantomData;
use types::Place;
pub use types::{Category, Field, FieldType, Key, Kind, Preset, Range, Rule, Typed, Word};
pub use values::*;

const ANY: Range = Range { low: f64::NEG_INFINITY, high: f64::INFINITY, above: false };
const POSITIVE: Range = Range { low: 0.0, high: f64::INFINITY, above: true };
const NOT_NEGATIVE: Range = Range { low: 0.0, high: f64::INFINITY, above: false };

/// Of an angle of view: up to 179°.
const VIEW: Range = Range { low: 0.0, high: 179.0 / 180.0 * std::f64::consts::PI, above: true };

/// Of a spot's cone: up to all directions.
const CONE_ANGLE: Range = Range { low: 0.0, high: 2.0 * std::f64::consts::PI, above: true };

/// Of a reflectance: a surface that gives back more than it receives is refused.
const REFLECTANCE: Range = within(0.0, 1.0);

const fn within(low: f64, high: f64) -> Range {
    Range { low, high, above: false }
}

/// Index of a kind in [`KINDS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct KindId(pub u8);

impl KindId {
    /// The kind itself.
    #[inline]
    pub fn get(self) -> &'static Kind {
        &KINDS[self.0 as usize]
    }

    /// All its fields: its own, then those every shape or group takes.
    pub fn fields(self) -> impl Iterator<Item = &'static Field> + Clone {
        self.get().fields.iter().chain(self.common())
    }

    /// How many fields [`KindId::fields`] has.
    pub fn field_count(self) -> usize {
        self.get().fields.len() + self.common().len()
    }

    /// The field at an index of [`KindId::fields`].
    #[inline]
    pub fn field(self, index: usize) -> &'static Field {
        let own = self.get().fields;
        own.get(index).unwrap_or_else(|| &self.common()[index - own.len()])
    }

    /// The index in [`KindId::fields`] of the field of that name.
    pub fn field_index(self, name: &str) -> Option<usize> {
        self.fields().position(|field| field.name == name)
    }

    fn common(self) -> &'static [Field] {
        if matches!(self.get().category, Category::Shape | Category::Group) { PLACED } else { &[] }
    }
}

/// Finds a kind by name.
pub fn kind(name: &str) -> Option<KindId> {
    KINDS.iter().position(|kind| kind.name == name).map(|index| KindId(index as u8))
}

/// Whether things of a kind only stand inside another thing, as a `lens` in a `camera`.
pub fn is_part(name: &str) -> bool {
    let holds = |ty: FieldType| matches!(ty, FieldType::Part(part) if part == name);
    KINDS.iter().flat_map(|kind| kind.fields).any(|field| holds(field.ty))
}

macro_rules! kinds {
    ($(
        $(#[doc = $doc:literal])*
        $category:ident $module:ident $name:literal $(rules [$($rule:expr),*])? {
            $( $(#[doc = $field_doc:literal])* $key:ident $field:literal: $type:ident = $default:expr, $range:expr; )*
        }
    )*) => {
        /// Every kind the language knows.
        pub const KINDS: &[Kind] = &[$(Kind {
            name: $name,
            category: Category::$category,
            doc: concat!($($doc, "\n"),*).trim_ascii(),
            fields: $module::FIELDS,
            rules: &[$($($rule),*)?],
        },)*];

        #[allow(non_camel_case_types, clippy::upper_case_acronyms)]
        enum Order { $($module,)* }

        $(
            /// Keys to the fields of this kind.
            pub mod $module {
                use super::*;
                /// The kind itself.
                pub const KIND: KindId = KindId(Order::$module as u8);
                #[allow(non_camel_case_types, dead_code, clippy::upper_case_acronyms)]
                enum Index { $($key,)* End }
                $(
                    $(#[doc = $field_doc])*
                    pub const $key: Key<$type> = Key { place: Place::Own(Index::$key as usize), ty: PhantomData };
                )*
                pub(super) const FIELDS: &[Field] = &[$(Field {
                    name: $field,
                    ty: <$type as Typed>::TYPE,
                    default: $default,
                    range: $range,
                    doc: concat!($($field_doc, "\n"),*).trim_ascii(),
                },)*];
            }
        )*
    };
}

use Preset::{Absent, Required, Value};

/// The fields that every shape and group takes besides its own.
pub const PLACED: &[Field] = &[
    Field {
        name: "material",
        ty: Made::TYPE,
        default: Absent("the group's material, else a light grey `diffuse`"),
        range: ANY,
        doc: "What it is made of. In a group: of members that name none.",
    },
    Field {
        name: "at",
        ty: Point::TYPE,
        default: Value("0"),
        range: ANY,
        doc: "Where its origin stands. Moves last, after `place`.",
    },
    Field {
        name: "place",
        ty: Transform::TYPE,
        default: Absent("as it is"),
        range: ANY,
        doc: "A pipeline read left to right: `scale(2) |> turn(z: 10deg) |> move(0, 1m, 0)`.",
    },
    Field {
        name: "grain",
        ty: Transform::TYPE,
        default: Absent("the thing's own space, which moves with it"),
        range: ANY,
        doc: "Where the space of its texture lies in that around the thing, so that several can be cut from one \
              block. In a group: where it lies in the group, for members that have none.",
    },
];

/// Keys to the fields of [`PLACED`].
pub mod placed {
    use super::*;
    /// What it is made of.
    pub const MATERIAL: Key<Made> = Key { place: Place::Common(0), ty: PhantomData };
    /// Where its origin stands.
    pub const AT: Key<Point> = Key { place: Place::Common(1), ty: PhantomData };
    /// A pipeline of transforms.
    pub const PLACE: Key<Transform> = Key { place: Place::Common(2), ty: PhantomData };
    /// Where the space of its texture lies.
    pub const GRAIN: Key<Transform> = Key { place: Place::Common(3), ty: PhantomData };
}

/// Angle of view in radians where neither camera nor lens says: the words of `fov` say the same.
pub const DEFAULT_FOV: f64 = 40.0 / 180.0 * std::f64::consts::PI;

/// Samples a pixel where the file says neither samples nor noise: the words of `samples` say the same.
pub const DEFAULT_SAMPLES: u32 = 64;

/// The material of whatever names none, and the built-in colour of materials that give none.
pub const DEFAULT_COLOR: &str = "#cccccc";

kinds! {
    /// A ball.
    Shape sphere "sphere" {
        /// From the centre to the surface.
        RADIUS "radius": Length = Required, POSITIVE;
    }

    /// A hyperboloid about the y axis. With two sheets: y²/b² − x²/a² − z²/c² = 1, a bowl above and one
    /// below with tips at y = ±b. With one: x²/a² + z²/c² − y²/b² = 1, a waisted tower.
    Shape hyperboloid "hyperboloid" rules [Rule::Needs("open", "height")] {
        /// The lengths (a, b, c) of the equation.
        AXES "axes": Point = Required, POSITIVE;
        /// Two bowls, or one tower.
        SHEETS "sheets": Int = Value("2"), within(1.0, 2.0);
        /// Keeps |y| ≤ height/2 and closes it with flat caps: its middle is at the origin.
        HEIGHT "height": Length = Absent("without end"), POSITIVE;
        /// Leaves the caps away.
        OPEN "open": Bool = Value("false"), ANY;
    }

    /// A bowl about the y axis with its vertex at the origin, opening upwards: y = height · (x² + z²) / radius².
    /// It stands on its origin, and ends at y = height.
    Shape paraboloid "paraboloid" {
        /// Of the rim, at y = height.
        RADIUS "radius": Length = Required, POSITIVE;
        /// From the vertex to the rim.
        HEIGHT "height": Length = Required, POSITIVE;
        /// Leaves the flat cap over the rim away.
        OPEN "open": Bool = Value("false"), ANY;
    }

    /// A cone about the y axis. It stands on its origin: the base is at y = 0, the apex at y = height.
    Shape cone "cone" {
        /// Of the base.
        RADIUS "radius": Length = Required, POSITIVE;
        /// From the base to the apex.
        HEIGHT "height": Length = Required, POSITIVE;
        /// The radius at y = height, of a cone that is cut off before its apex; it may exceed `radius`.
        TOP "top": Length = Value("0"), NOT_NEGATIVE;
        /// Leaves the flat caps away.
        OPEN "open": Bool = Value("false"), ANY;
    }

    /// A cylinder about the y axis. It stands on its origin, from y = 0 to y = height.
    Shape cylinder "cylinder" {
        /// From the axis to the side.
        RADIUS "radius": Length = Required, POSITIVE;
        /// From the lower end to the upper.
        HEIGHT "height": Length = Required, POSITIVE;
        /// Leaves the flat caps away: a pipe with a wall of no thickness.
        OPEN "open": Bool = Value("false"), ANY;
    }

    /// A flat disc about its origin. It encloses nothing; as an emitter it glows on both sides.
    Shape disk "disk" {
        /// From the centre to the rim.
        RADIUS "radius": Length = Required, POSITIVE;
        /// Perpendicular to it. Need not be of length 1.
        NORMAL "normal": Vector = Value("(0, 1, 0)"), ANY;
    }

    /// A box with its middle at the origin and its edges along the axes.
    Shape cuboid "box" {
        /// Edge lengths along x, y and z.
        SIZE "size": Point = Required, POSITIVE;
    }

    /// Triangles from a PLY or OBJ file. A mesh is closed, and may be of glass, if each edge is shared by two triangles
    /// that are oriented alike; else it is an open surface.
    Shape mesh "mesh" {
        /// Path of the file, as seen from the folder of this one.
        FILE "file": Text = Required, ANY;
        /// What a length of 1 in the file is.
        UNIT "unit": Length = Value("1m"), POSITIVE;
        /// Whether it is shaded as if it were round: by the file's normals, or else by means of those of neighbouring
        /// triangles.
        SMOOTH "smooth": Bool = Value("true"), ANY;
    }

    /// An endless plane through its origin. The solid half-space lies behind the normal.
    Shape plane "plane" {
        /// Out of the ground. Need not be of length 1.
        NORMAL "normal": Vector = Value("(0, 1, 0)"), ANY;
    }

    /// Things that are placed together.
    Group group "group" {}

    /// Lambertian: scatters evenly, like plaster or paper. The report's opaque material.
    Material diffuse "diffuse" {
        /// Reflectance.
        COLOR "color": Paint = Value(DEFAULT_COLOR), REFLECTANCE;
    }

    /// A perfect mirror. The report's specular material.
    Material mirror "mirror" {
        /// Reflectance, the same at every angle.
        COLOR "color": Paint = Value("#f8f8f8"), REFLECTANCE;
    }

    /// Glass, water and the like: refraction by Snell's law, reflection by Fresnel's equations. The report's
    /// transparent material.
    Material dielectric "dielectric" {
        /// Refractive index.
        IOR "ior": Number = Value("1.5"), within(0.1, 10.0);
        /// White light has this colour after travelling `depth` inside.
        TINT "tint": Color = Value("white"), REFLECTANCE;
        /// See `tint`.
        DEPTH "depth": Length = Value("1cm"), POSITIVE;
        /// What is absorbed besides, linear and per metre, as tables of materials give it: a share of
        /// exp(−absorption × metres) is left.
        ABSORPTION "absorption": Color = Value("black"), NOT_NEGATIVE;
        /// From 0, polished, to 1, frosted (GGX with α = roughness²).
        ROUGHNESS "roughness": Number = Value("0"), within(0.0, 1.0);
    }

    /// A conductor: GGX microfacets, single scattering, with Schlick's Fresnel term.
    Material metal "metal" {
        /// Reflectance at normal incidence.
        COLOR "color": Paint = Value("#e0e0e0"), REFLECTANCE;
        /// From 0, polished, to 1, rough (GGX with α = roughness²).
        ROUGHNESS "roughness": Number = Value("0"), within(0.0, 1.0);
    }

    /// A clear coat over a diffuse base; light reflected inside the coat is counted.
    Material plastic "plastic" {
        /// Reflectance of the base.
        COLOR "color": Paint = Value(DEFAULT_COLOR), REFLECTANCE;
        /// Refractive index of the coat.
        IOR "ior": Number = Value("1.5"), within(1.0, 10.0);
        /// Of the coat: from 0, polished, to 1, rough (GGX with α = roughness²).
        ROUGHNESS "roughness": Number = Value("0"), within(0.0, 1.0);
    }

    /// Glows, and reflects nothing. A closed shape glows outwards, an open one on both sides.
    Material emitter "emitter" rules [Rule::ExactlyOne(&["power", "radiance"])] {
        /// Multiplies the power or the radiance. A texture needs `radiance`: the power of what it leaves is not known.
        COLOR "color": Paint = Value("white"), NOT_NEGATIVE;
        /// Radiated by the whole surface, on both sides where it is open.
        POWER "power": Power = Absent("from `radiance`"), NOT_NEGATIVE;
        /// Per steradian.
        RADIANCE "radiance": Radiance = Absent("from `power`"), NOT_NEGATIVE;
    }

    /// A lamp: a point, a glowing sphere that is seen, or a spot: a point that shines into a cone.
    Light light "light" rules [
        Rule::Excludes("cone", &["radius"]),
        Rule::Together(&["aim", "cone"]),
        Rule::Needs("soft", "cone")
    ] {
        /// Its centre.
        AT "at": Point = Value("0"), ANY;
        /// Radiated in all directions together, by a spot what leaves the cone; each channel is power × color.
        POWER "power": Power = Required, NOT_NEGATIVE;
        /// Multiplies the power.
        COLOR "color": Color = Value("white"), NOT_NEGATIVE;
        /// 0 is a point, which casts hard shadows and is not seen; else a glowing sphere.
        RADIUS "radius": Length = Value("0"), NOT_NEGATIVE;
        /// What a spot shines at: a point or a thing's middle.
        AIM "aim": Aim = Absent("not a spot: it shines in all directions"), ANY;
        /// A spot's full angle.
        CONE "cone": Angle = Absent("see `aim`"), CONE_ANGLE;
        /// The share of a spot's cone, from its edge inwards, over which the light fades: 0 is a sharp edge, 1 fades
        /// from the axis on.
        SOFT "soft": Number = Value("0"), within(0.0, 1.0);
    }

    /// A distant disc of light.
    Light sun "sun" {
        /// Towards the sun. Need not be of length 1.
        FROM "from": Vector = Required, ANY;
        /// On a surface that faces it.
        IRRADIANCE "irradiance": Radiance = Required, NOT_NEGATIVE;
        /// Its apparent diameter; 0 casts hard shadows.
        ANGLE "angle": Angle = Value("0.53deg"), within(0.0, std::f64::consts::PI);
        /// Multiplies the irradiance.
        COLOR "color": Color = Value("white"), NOT_NEGATIVE;
    }

    /// Light from everywhere beyond the scene; what is seen where nothing stands.
    Light sky "sky" rules [Rule::Excludes("image", &["color"]), Rule::Needs("turn", "image")] {
        /// Multiplies the radiance.
        COLOR "color": Color = Value("white"), NOT_NEGATIVE;
        /// A picture of all directions (longitude across, latitude down), as PNG, JPEG, WebP, HDR or EXR. It
        /// multiplies the radiance. Its centre lies at −z, its top at +y.
        IMAGE "image": Text = Absent("one `color`"), ANY;
        /// Turns the picture about the y axis, as `turn(y: …)` does a thing: by 90deg its centre lies at −x.
        TURN "turn": Angle = Value("0"), ANY;
        /// Per steradian.
        RADIANCE "radiance": Radiance = Value("1W/m2"), NOT_NEGATIVE;
    }

    /// Where the picture is taken from.
    Block camera "camera" rules [Rule::Excludes("width", &["fov", "lens"])] {
        /// The centre of the lens.
        FROM "from": Point = Absent("a three-quarter view that frames every bounded thing"), ANY;
        /// What stands in the middle of the picture.
        LOOK "look": Aim = Absent("the middle of every bounded thing"), ANY;
        /// This direction is upright in the picture.
        UP "up": Vector = Value("(0, 1, 0)"), ANY;
        /// Angle of view across the width.
        FOV "fov": Angle = Absent("40deg, or what the lens gives"), VIEW;
        /// Makes the camera orthographic: all rays are parallel, and the picture shows this width of the scene,
        /// from the plane through `from` on.
        WIDTH "width": Length = Absent("a camera with perspective"), POSITIVE;
        /// In stops: 0 shows radiance 1 as white, 1 is twice as bright.
        EXPOSURE "exposure": Exposure = Value("auto"), within(-100.0, 100.0);
        /// Depth of field.
        LENS "lens": LensPart = Absent("a pinhole: everything is sharp"), ANY;
    }

    /// The lens of a camera: what lies off the plane of focus is blurred. Give an `aperture`, or `focal` and
    /// `stop` as a photographer would. May also stand at the top level beside the only camera.
    Block lens "lens" rules [
        Rule::Excludes("aperture", &["focal", "stop", "sensor"]),
        Rule::ExactlyOne(&["aperture", "focal"]),
        Rule::Together(&["focal", "stop"]),
        Rule::Needs("sensor", "focal")
    ] {
        /// The plane that is sharp: its distance along the view, or a point or thing it goes through.
        FOCUS "focus": Focus = Absent("what the camera looks at"), POSITIVE;
        /// Diameter of the opening.
        APERTURE "aperture": Length = Absent("`focal` / `stop`"), NOT_NEGATIVE;
        /// Focal length; with `sensor` it gives the angle of view.
        FOCAL "focal": Length = Absent("from the camera's `fov`"), POSITIVE;
        /// The f-number.
        STOP "stop": Number = Absent("see `focal`"), POSITIVE;
        /// Width of the sensor.
        SENSOR "sensor": Length = Value("36mm"), POSITIVE;
    }

    /// How the picture is made.
    Block render "render" rules [Rule::Excludes("noise", &["samples"])] {
        /// Width and height in pixels.
        SIZE "size": Size = Value("(640, 480)"), within(1.0, 65_536.0);
        /// Camera paths a pixel.
        SAMPLES "samples": Int = Absent("64, or as many as `noise` needs"), within(1.0, 1_048_576.0);
        /// Stop when the standard error of 99 of 100 displayed pixels is below this share of white.
        NOISE "noise": Number = Absent("see `samples`"), Range { low: 0.0, high: 1.0, above: true };
        /// Scattering events of a path: 0 shows what glows, 1 adds direct light.
        BOUNCES "bounces": Int = Value("8"), within(0.0, 1024.0);
        /// Whether light also comes by way of diffuse surfaces. Without: straight from the lights, plus mirrors
        /// and glass.
        INDIRECT "indirect": Bool = Value("true"), ANY;
        /// Chooses the random numbers.
        SEED "seed": Int = Value("0"), within(0.0, 9_007_199_254_740_991.0);
        /// Which camera takes the picture, where there are several.
        CAMERA "camera": CameraName = Absent("the only one"), ANY;
        /// The curve from scene to display.
        TONEMAP "tonemap": TonemapWord = Value("neutral"), ANY;
        /// How a pixel weighs the light around it.
        FILTER "filter": FilterWord = Value("gaussian"), ANY;
        /// What is seen where nothing stands.
        BACKGROUND "background": BackgroundWord = Value("sky"), ANY;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_fits_its_indices() {
        assert!(KINDS.len() <= usize::from(u8::MAX));
        for index in 0..KINDS.len() {
            let kind = KindId(index as u8);
            assert!(kind.field_count() <= 64, "{} has more fields than a set holds", kind.get().name);
            assert!(super::kind(kind.get().name) == Some(kind), "{} is there twice", kind.get().name);
            for (place, field) in kind.fields().enumerate() {
                assert_eq!(kind.field_index(field.name), Some(place), "{} is there twice", field.name);
            }
        }
    }

    #[test]
    fn words_about_defaults_that_lowering_chooses_are_true() {
        let says = |key: usize, kind: KindId, words: String| match kind.field(key).default {
            Absent(text) => assert!(text.starts_with(&words), "{text}"),
            other => panic!("{other:?}"),
        };
        let degrees = DEFAULT_FOV * 180.0 / std::f64::consts::PI;
        says(camera::FOV.index(camera::KIND), camera::KIND, format!("{degrees:.0}deg"));
        says(render::SAMPLES.index(render::KIND), render::KIND, format!("{DEFAULT_SAMPLES},"));
    }
}

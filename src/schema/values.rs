//! The types that fields have, and the words that some take.

use super::{Category, FieldType, Typed, Word};
use crate::units;

macro_rules! types {
    ($($(#[doc = $doc:literal])* $name:ident = $type:expr;)*) => {
        $($(#[doc = $doc])* #[derive(Debug)] pub enum $name {}
        impl Typed for $name { const TYPE: FieldType = $type; })*
    };
}

types! {
    /// A plain number.
    Number = FieldType::Scalar(units::NONE);
    /// A length in metres.
    Length = FieldType::Scalar(units::LENGTH);
    /// An angle in radians.
    Angle = FieldType::Scalar(units::ANGLE);
    /// A power in watts.
    Power = FieldType::Scalar(units::POWER);
    /// Radiance or irradiance in W/m².
    Radiance = FieldType::Scalar(units::RADIANCE);
    /// A whole number.
    Int = FieldType::Int;
    /// `true` or `false`.
    Bool = FieldType::Bool;
    /// A linear colour.
    Color = FieldType::Color;
    /// A colour or a texture.
    Paint = FieldType::Paint;
    /// A text.
    Text = FieldType::Text;
    /// Three lengths.
    Point = FieldType::Tuple(3, units::LENGTH);
    /// Three numbers.
    Vector = FieldType::Tuple(3, units::NONE);
    /// Width and height in pixels.
    Size = FieldType::IntTuple(2);
    /// A placement.
    Transform = FieldType::Transform;
    /// A material.
    Made = FieldType::Made(Category::Material);
    /// The lens of a camera.
    LensPart = FieldType::Part("lens");
    /// A point, or a thing whose middle is meant.
    Aim = FieldType::OneOf(&[FieldType::Tuple(3, units::LENGTH), FieldType::Target]);
    /// A distance along the view, a point, or a thing.
    Focus = FieldType::OneOf(&[
        FieldType::Scalar(units::LENGTH),
        FieldType::Tuple(3, units::LENGTH),
        FieldType::Target,
    ]);
    /// A number of stops, or `auto`.
    Exposure = FieldType::OneOf(&[FieldType::Choice(AUTO), FieldType::Scalar(units::NONE)]);
    /// The name of a camera.
    CameraName = FieldType::Named("camera");
    /// A reconstruction filter.
    FilterWord = FieldType::Choice(Filter::WORDS);
    /// What is behind everything.
    BackgroundWord = FieldType::Choice(Background::WORDS);
    /// A tone curve.
    TonemapWord = FieldType::Choice(Tonemap::WORDS);
}

/// The word that leaves a choice to the renderer.
pub const AUTO: &[Word] = &[Word { name: "auto", doc: "Chosen from the scene, and printed." }];

macro_rules! choice {
    ($(#[doc = $doc:literal])* $name:ident { $(#[doc = $word_doc:literal] $variant:ident $word:literal,)* }) => {
        $(#[doc = $doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
        pub enum $name { $(#[doc = $word_doc] $variant,)* }

        impl $name {
            /// The words as written, with what they mean.
            pub const WORDS: &'static [Word] =
                &[$(Word { name: $word, doc: $word_doc.trim_ascii() },)*];

            /// Reads one of the words.
            pub fn from_word(word: &str) -> Option<$name> {
                match word { $($word => Some($name::$variant),)* _ => None }
            }

            /// As written.
            pub fn word(self) -> &'static str {
                match self { $($name::$variant => $word,)* }
            }
        }
    };
}

choice! {
    /// Reconstruction filter: how a pixel weighs the light around its centre.
    Filter {
        /// Evenly over one pixel.
        Box "box",
        /// Falls linearly to zero over one pixel.
        Tent "tent",
        /// A bell of standard deviation half a pixel, to 1.5 pixels.
        Gaussian "gaussian",
        /// Mitchell and Netravali's cubic with B = C = 1/3, to 2 pixels: crisp, slightly negative at its edge.
        Mitchell "mitchell",
    }
}

choice! {
    /// What is seen where nothing stands.
    Background {
        /// The sky and the suns.
        Sky "sky",
        /// Nothing: there the picture is transparent, unless seen in a mirror or through glass. The sky still lights.
        Transparent "transparent",
    }
}

choice! {
    /// The curve from scene radiance to display.
    Tonemap {
        /// Khronos PBR Neutral: keeps colours as they are, and rolls off the highlights.
        Neutral "neutral",
        /// Linear, cut at white.
        None "none",
        /// AgX: filmic, highlights go towards white.
        Agx "agx",
    }
}

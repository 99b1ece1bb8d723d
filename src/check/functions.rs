//! The built-in functions and what they take.

use super::types::{Element, NUMBER, Type};
use super::{Checker, Expr, ExprKind, errors, textures};
use crate::schema::Category;
use crate::span::Span;
use crate::syntax::ast::{Argument, ExprKind as Tree};
use crate::units::{self, ANGLE, LENGTH, TEMPERATURE};

macro_rules! functions {
    ($($(#[doc = $doc:literal])* $variant:ident $name:literal $signature:literal $types:literal,)*) => {
        /// A built-in function.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Function { $($(#[doc = $doc])* $variant,)* }

        impl Function {
            /// Every function, in the order of the reference.
            pub const ALL: &'static [Function] = &[$(Function::$variant,)*];

            /// As written.
            pub fn name(self) -> &'static str {
                match self { $(Function::$variant => $name,)* }
            }

            /// How it is called.
            pub fn signature(self) -> &'static str {
                match self { $(Function::$variant => $signature,)* }
            }

            /// The types of what it takes, in each of the ways to call it, and of what it gives. `quantity` is a number with or
            /// without a unit, `triple` three of them, and `value` either, or a colour.
            fn types(self) -> &'static str {
                match self { $(Function::$variant => $types,)* }
            }

            /// What it gives.
            pub fn doc(self) -> &'static str {
                match self { $(Function::$variant => concat!($($doc),*).trim_ascii(),)* }
            }
        }
    };
}

functions! {
    /// Sine of an angle.
    Sin "sin" "sin(angle)" "angle -> number",
    /// Cosine of an angle.
    Cos "cos" "cos(angle)" "angle -> number",
    /// Tangent of an angle.
    Tan "tan" "tan(angle)" "angle -> number",
    /// The angle between −90° and 90° with this sine.
    Asin "asin" "asin(number)" "number -> angle",
    /// The angle between 0° and 180° with this cosine.
    Acos "acos" "acos(number)" "number -> angle",
    /// The angle of the point (x, y) from the x axis.
    Atan2 "atan2" "atan2(y, x)" "quantity, quantity -> angle",
    /// Square root; of an area, a length.
    Sqrt "sqrt" "sqrt(value)" "quantity -> quantity",
    /// Without its sign.
    Abs "abs" "abs(value)" "quantity -> quantity",
    /// The least of them.
    Min "min" "min(a, b, …)" "quantity, quantity, … -> quantity",
    /// The greatest of them.
    Max "max" "max(a, b, …)" "quantity, quantity, … -> quantity",
    /// The value, kept between low and high.
    Clamp "clamp" "clamp(value, low, high)" "quantity, quantity, quantity -> quantity",
    /// From a at t = 0 to b at t = 1; of quantities, triples and colours.
    Mix "mix" "mix(a, b, t)" "value, value, number -> value",
    /// The next whole number below.
    Floor "floor" "floor(number)" "number -> int",
    /// The next whole number above.
    Ceil "ceil" "ceil(number)" "number -> int",
    /// The nearest whole number; halves go away from zero.
    Round "round" "round(number)" "number -> int",
    /// The remainder of a / b, with the sign of b.
    Mod "mod" "mod(a, b)" "quantity, quantity -> quantity",
    /// a to the power b.
    Pow "pow" "pow(a, b)" "number, number -> number",
    /// e to a power.
    Exp "exp" "exp(number)" "number -> number",
    /// Natural logarithm.
    Log "log" "log(number)" "number -> number",
    /// Length of a triple; of a list, how many items it has.
    Length "length" "length(v)" "triple -> quantity",
    /// The vector of length 1 in the same direction.
    Normalize "normalize" "normalize(v)" "triple -> vector",
    /// Scalar product.
    Dot "dot" "dot(a, b)" "triple, triple -> quantity",
    /// Vector product.
    Cross "cross" "cross(a, b)" "triple, triple -> triple",
    /// The whole numbers from a, or 0, up to but not including b.
    Range "range" "range(b) or range(a, b)" "int or int, int -> [int]",
    /// So many values, evenly from a to b, both included; of quantities and triples.
    Linspace "linspace" "linspace(a, b, count)" "value, value, int -> [value]",
    /// A number from 0 up to but not including 1, which looks random and is always the same for the same numbers.
    Rand "rand" "rand(i, j, …)" "number, number, … -> number",
    /// The box around a thing: its `.min`, `.max`, `.center` and `.size`.
    Bounds "bounds" "bounds(thing)" "thing -> bounds",
    /// A linear colour.
    Rgb "rgb" "rgb(r, g, b)" "number, number, number -> color",
    /// A display-referred colour, as colour pickers show it; each channel from 0 to 1.
    Srgb "srgb" "srgb(r, g, b)" "number, number, number -> color",
    /// A display-referred colour by hue, saturation and value.
    Hsv "hsv" "hsv(angle, s, v)" "angle, number, number -> color",
    /// The colour of a glowing body, at luminance 1.
    Blackbody "blackbody" "blackbody(temperature)" "temperature -> color",
    /// Cubes of two colours or textures that alternate.
    Checker "checker" "checker(a, b, size)" "texture, texture, length -> texture",
    /// Layers of two colours or textures that alternate.
    Stripes "stripes" "stripes(a, b, width, along)" "texture, texture, length, vector -> texture",
    /// Clouds of two colours or textures.
    Noise "noise" "noise(a, b, size, octaves, seed)" "texture, texture, length, int, int -> texture",
    /// A picture from a file, laid on the surface.
    Image "image" "image(file, size)" "text, length -> texture",
    /// The rows of a table in a CSV file, as a list: `row.column` of each. The path is written out.
    Table "table" "table(file)" "text -> [row]",
    /// A placement that enlarges about the origin.
    Scale "scale" "scale(k) or scale(x, y, z)" "number or number, number, number -> transform",
    /// A placement that turns about one axis: from x to y about z, and so on.
    Turn "turn" "turn(x: angle), turn(y: angle) or turn(z: angle)" "angle or angle or angle -> transform",
    /// A placement that moves.
    Move "move" "move(x, y, z) or move(point)" "length, length, length or point -> transform",
    /// A placement that takes the axes to three vectors, and the origin to a point.
    Matrix "matrix" "matrix(x, y, z, origin)" "vector, vector, vector, point -> transform",
}

/// A way to call a built-in function.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Way {
    /// What it takes, in order: each name with its type. The last is `…`, without a type, where more may follow.
    pub takes: Vec<(&'static str, &'static str)>,
    /// The type of what it gives.
    pub gives: &'static str,
}

impl Function {
    /// The ways to call it, by the types of what it takes.
    pub fn ways(self) -> Vec<Way> {
        let (taken, gives) = self.types().split_once(" -> ").unwrap_or((self.types(), ""));
        let calls = self.signature().split(" or ").flat_map(|call| call.split("), "));
        let way = |(call, types): (&'static str, &'static str)| {
            let names = call.split_once('(').map_or("", |(_, names)| names.trim_end_matches(')'));
            let name = |name: &'static str| name.split(':').next().unwrap_or(name);
            Way { takes: names.split(", ").map(name).zip(types.split(", ")).collect(), gives }
        };
        calls.zip(taken.split(" or ")).map(way).collect()
    }
}

/// Finds a function by name.
pub fn by_name(name: &str) -> Option<Function> {
    Function::ALL.iter().copied().find(|function| function.name() == name)
}

impl Checker<'_> {
    /// Checks a call of a built-in function.
    pub(super) fn call_built_in(
        &mut self,
        function: Function,
        arguments: &[Argument],
        span: Span,
    ) -> (ExprKind, Type) {
        if let (Function::Turn, [angle, Argument { name: None, value: axis }]) = (function, arguments)
            && let Tree::Name(name) = &axis.kind
            && matches!(name.as_str(), "x" | "y" | "z")
            && !self.is_declared(name)
        {
            self.infer(&angle.value);
            let angle = self.text(angle.value.span);
            self.report(errors::turn_axis(axis.span).help(format!("write `turn({name}: {angle})`")));
            return (ExprKind::Invalid, Type::Invalid);
        }
        let (values, types): (Vec<Expr>, Vec<Type>) = (arguments.iter().enumerate())
            .map(|(index, argument)| match (function, index) {
                (Function::Image, 0) => self.infer_path(&argument.value),
                _ => self.infer(&argument.value),
            })
            .unzip();
        if let Some(parameters) = textures::parameters(function) {
            let values = values.into_iter().zip(types).collect();
            return self.texture(function, parameters, arguments, values, span);
        }
        if types.contains(&Type::Invalid) {
            return (ExprKind::Invalid, Type::Invalid);
        }
        if function == Function::Turn && arguments.len() > 1 {
            // What else stands there, such as a vector as the axis, cannot be told apart into angles.
            let is_angle = |ty: &Type| {
                matches!(ty, Type::Scalar(Element::Zero)) || *ty == Type::Scalar(Element::Quantity(ANGLE))
            };
            let angles = arguments.len() <= 3 && types.iter().all(is_angle);
            let turns = if angles { self.turns(arguments) } else { Vec::new() };
            self.report(errors::turn_axes(&turns, span));
            return (ExprKind::Invalid, Type::Invalid);
        }
        let axis = match self.argument_names(function, arguments) {
            Ok(axis) => axis,
            Err(diagnostic) => {
                self.report(*diagnostic);
                return (ExprKind::Invalid, Type::Invalid);
            }
        };
        let Some(ty) = self.returns(function, span, &values, &types) else {
            return (ExprKind::Invalid, Type::Invalid);
        };
        let mut values = values;
        let numbers = types.iter().chain([&ty]).all(|ty| matches!(ty, Type::Scalar(_)));
        if numbers {
            return (ExprKind::Compute { function, arguments: values }, ty);
        }
        if let Some(axis) = axis {
            // `turn` takes its axis as a first argument from here on.
            values.insert(0, Expr { kind: ExprKind::Number(axis as f64), span });
        }
        (ExprKind::Call { function, arguments: values }, ty)
    }

    /// The turns that a `turn` about several axes means, each as it would be written. One that names no axis is about
    /// the next one, as where three angles stand together; by nothing, it is left out.
    fn turns(&self, arguments: &[Argument]) -> Vec<String> {
        let axes = ["x", "y", "z"];
        let turns = arguments.iter().zip(axes).filter_map(|(argument, axis)| {
            let named = argument.name.as_ref().map(|name| name.text.as_str());
            let axis = named.filter(|name| axes.contains(name)).unwrap_or(axis);
            let angle = self.text(argument.value.span).trim();
            let angle = if angle.len() > 40 || angle.contains('\n') { "…" } else { angle };
            (angle != "0").then(|| format!("turn({axis}: {angle})"))
        });
        turns.collect()
    }

    /// Only `turn` names its argument: gives the axis.
    fn argument_names(
        &self,
        function: Function,
        arguments: &[Argument],
    ) -> Result<Option<usize>, Box<crate::diagnostic::Diagnostic>> {
        let mut axis = None;
        for argument in arguments {
            match (&argument.name, function) {
                (None, Function::Turn) => return Err(Box::new(errors::turn_axis(argument.value.span))),
                (None, _) => {}
                (Some(name), Function::Turn) => {
                    axis = ["x", "y", "z"].iter().position(|axis| *axis == name.text);
                    if axis.is_none() {
                        return Err(Box::new(errors::turn_axis(name.span)));
                    }
                }
                (Some(name), _) => return Err(Box::new(errors::named_argument(function, name))),
            }
        }
        Ok(axis)
    }

    fn returns(&mut self, function: Function, span: Span, values: &[Expr], types: &[Type]) -> Option<Type> {
        use Function::*;
        let counts: &[usize] = match function {
            Sin | Cos | Tan | Asin | Acos | Sqrt | Abs | Floor | Ceil | Round | Exp | Log | Length
            | Normalize | Blackbody | Turn | Bounds | Table => &[1],
            Atan2 | Mod | Pow | Dot | Cross => &[2],
            Clamp | Mix | Rgb | Srgb | Hsv | Linspace => &[3],
            Scale | Move => &[1, 3],
            Matrix => &[4],
            Range => &[1, 2],
            Min | Max | Rand | Checker | Stripes | Noise | Image => &[],
        };
        let least = if function == Rand { 1 } else { 2 };
        if counts.is_empty() && values.len() < least || !counts.is_empty() && !counts.contains(&values.len())
        {
            self.report(errors::argument_count(function, span, values.len()));
            return None;
        }
        let number = units::NONE;
        let mut arguments = Arguments { checker: self, function, values, types };
        match function {
            Sin | Cos | Tan => arguments.each(&[ANGLE], Type::Scalar(NUMBER)),
            Asin | Acos => arguments.each(&[number], Type::Scalar(Element::Quantity(ANGLE))),
            Exp | Log => arguments.each(&[number], Type::Scalar(NUMBER)),
            Pow => arguments.each(&[number, number], Type::Scalar(NUMBER)),
            Floor | Ceil | Round => arguments.each(&[number], Type::Scalar(Element::Int)),
            Rgb | Srgb => arguments.each(&[number, number, number], Type::Color),
            Hsv => arguments.each(&[ANGLE, number, number], Type::Color),
            Blackbody => arguments.each(&[TEMPERATURE], Type::Color),
            Turn => arguments.each(&[ANGLE], Type::Transform),
            Scale => arguments.each(&[number; 3][..values.len()], Type::Transform),
            Move if values.len() == 3 => arguments.each(&[LENGTH; 3], Type::Transform),
            Move => {
                arguments.triple(0, Some(LENGTH))?;
                Some(Type::Transform)
            }
            Matrix => {
                for index in 0..3 {
                    arguments.triple(index, Some(number))?;
                }
                arguments.triple(3, Some(LENGTH))?;
                Some(Type::Transform)
            }
            Atan2 => arguments.joined(0..2).map(|_| Type::Scalar(Element::Quantity(ANGLE))),
            Min | Max | Clamp | Mod => arguments.joined(0..values.len()).map(Type::Scalar),
            Abs => arguments.joined(0..1).map(Type::Scalar),
            Sqrt => {
                let element = arguments.joined(0..1)?;
                arguments.root(element)
            }
            Mix => arguments.mix(),
            // By their parameters.
            Checker | Stripes | Noise | Image => None,
            // Is read where it stands.
            Table => None,
            Length if matches!(types[0], Type::List(_)) => Some(Type::Scalar(Element::Int)),
            Length => arguments.triple(0, None).map(Type::Scalar),
            Range => arguments.whole(0..values.len()).map(|()| Type::list(Type::Scalar(Element::Int))),
            Linspace => arguments.linspace(),
            Rand => {
                let wanted = vec![number; values.len()];
                arguments.each(&wanted, Type::Scalar(NUMBER))
            }
            Bounds => arguments.bounded(),
            Normalize => arguments.triple(0, None).map(|_| Type::Tuple(3, NUMBER)),
            Dot | Cross => {
                let (a, b) = (arguments.triple(0, None)?, arguments.triple(1, None)?);
                let Some(dim) = a.dim().times(b.dim()) else {
                    arguments.checker.report(errors::exponent(span));
                    return None;
                };
                let element = Element::Quantity(dim);
                Some(if function == Dot { Type::Scalar(element) } else { Type::Tuple(3, element) })
            }
        }
    }
}

/// The arguments of one call, being checked.
struct Arguments<'c, 'a, 'v> {
    checker: &'c mut Checker<'a>,
    function: Function,
    values: &'v [Expr],
    types: &'v [Type],
}

impl Arguments<'_, '_, '_> {
    /// Each argument is a quantity of its own dimension.
    fn each(&mut self, wanted: &[units::Dim], gives: Type) -> Option<Type> {
        let fits =
            |index: usize| matches!(self.types[index], Type::Scalar(element) if element.fits(wanted[index]));
        let mut wrong: Vec<usize> = (0..wanted.len()).filter(|index| !fits(*index)).collect();
        let sound = wrong.is_empty();
        // Those that are wrong in the same way, such as three numbers without a unit, are one slip.
        while let Some(&first) = wrong.first() {
            let alike = |index: &usize| {
                wanted[*index] == wanted[first]
                    && self.types[*index].describe() == self.types[first].describe()
            };
            let (alike, others): (Vec<usize>, Vec<usize>) = wrong.iter().partition(|index| alike(index));
            let places: Vec<_> = alike
                .iter()
                .map(|&index| self.values[index].span)
                .map(|span| (span, self.checker.text(span)))
                .collect();
            self.checker.report(errors::arguments(self.function, wanted[first], &places, &self.types[first]));
            wrong = others;
        }
        sound.then_some(gives)
    }

    /// The arguments are quantities of one dimension, which this is.
    fn joined(&mut self, range: std::ops::Range<usize>) -> Option<Element> {
        let mut joined = Element::Zero;
        for index in range {
            let span = self.values[index].span;
            let Type::Scalar(element) = self.types[index] else {
                let ty = &self.types[index];
                self.checker.report(errors::argument(self.function, units::NONE, span, "", ty));
                return None;
            };
            joined = match joined.join(element) {
                Some(both) => both,
                None => {
                    let first = (self.values[0].span, &Type::Scalar(joined));
                    self.checker.report(errors::sum(
                        self.function.name(),
                        span,
                        [first, (span, &self.types[index])],
                    ));
                    return None;
                }
            };
        }
        Some(joined)
    }

    /// The arguments are whole numbers.
    fn whole(&mut self, range: std::ops::Range<usize>) -> Option<()> {
        let mut sound = true;
        for index in range {
            let ty = &self.types[index];
            if !matches!(ty, Type::Scalar(element) if element.is_int()) {
                sound = false;
                let span = self.values[index].span;
                self.checker.report(errors::whole_argument(self.function, span, ty));
            }
        }
        sound.then_some(())
    }

    fn linspace(&mut self) -> Option<Type> {
        self.whole(2..3)?;
        let plain = |element: Element| if element.is_int() { NUMBER } else { element };
        match (&self.types[0], &self.types[1]) {
            (Type::Tuple(m, x), Type::Tuple(n, y)) if m == n && x.join(*y).is_some() => {
                x.join(*y).map(|element| Type::list(Type::Tuple(*m, plain(element))))
            }
            _ => self.joined(0..2).map(|element| Type::list(Type::Scalar(plain(element)))),
        }
    }

    /// The argument is something with bounds.
    fn bounded(&mut self) -> Option<Type> {
        let ty = &self.types[0];
        let bounded = match ty {
            Type::Thing(making) => making.kind.is_placed() || making.kind.category() == Category::Light,
            Type::Made(making) => making.kind.is_placed(),
            _ => false,
        };
        if !bounded {
            self.checker.report(errors::no_bounds(self.values[0].span, ty));
        }
        bounded.then_some(Type::Bounds)
    }

    fn root(&mut self, element: Element) -> Option<Type> {
        let root = element.dim().root();
        if root.is_none() {
            self.checker.report(errors::root(self.values[0].span, &self.types[0]));
        }
        root.map(|dim| Type::Scalar(Element::Quantity(dim)))
    }

    fn mix(&mut self) -> Option<Type> {
        let t_fits = matches!(self.types[2], Type::Scalar(element) if element.fits(units::NONE));
        if !t_fits {
            let (span, ty) = (self.values[2].span, &self.types[2]);
            let text = self.checker.text(span);
            self.checker.report(errors::argument(self.function, units::NONE, span, text, ty));
            return None;
        }
        let plain = |element: Element| if element.dim() == units::NONE { NUMBER } else { element };
        match (&self.types[0], &self.types[1]) {
            (Type::Color, Type::Color) => Some(Type::Color),
            (Type::Tuple(m, x), Type::Tuple(n, y)) if m == n && x.join(*y).is_some() => {
                x.join(*y).map(|element| Type::Tuple(*m, plain(element)))
            }
            (Type::Scalar(_), Type::Scalar(_)) => {
                self.joined(0..2).map(|element| Type::Scalar(plain(element)))
            }
            _ => {
                let operands = [(self.values[0].span, &self.types[0]), (self.values[1].span, &self.types[1])];
                self.checker.report(errors::operands("mix", self.values[1].span, operands));
                None
            }
        }
    }

    /// The argument is a triple, of this dimension where one is wanted; gives what it counts.
    fn triple(&mut self, index: usize, dim: Option<units::Dim>) -> Option<Element> {
        match &self.types[index] {
            Type::Tuple(3, element) if dim.is_none_or(|dim| element.fits(dim)) => Some(*element),
            ty => {
                let span = self.values[index].span;
                self.checker.report(errors::triple_wanted(self.function, span, ty, dim));
                None
            }
        }
    }
}

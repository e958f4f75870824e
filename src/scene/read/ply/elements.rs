//! What the elements of a PLY file become.

use super::header::{
    CORNERS, Declared, ElementHeader as Declaration, NORMAL, Number, POSITION, PlyKind,
};
use ply_rs_bw::ply::{
    Addable, ElementDef, Property, PropertyAccess, PropertyAccessResult, PropertyDef, PropertyType,
    ScalarType,
};

/// An element of the payload, one of those below.
pub(super) trait Element: PropertyAccess {
    /// What is wrong with its values.
    fn problem(&self) -> Option<&'static str> {
        None
    }
}

/// The declaration for the parser: as what a property's numbers and a list's length are to be read.
/// What is not used has names that nothing else has.
pub(super) fn definition(
    element: &Declaration,
    kind: impl Fn(&Declared, Number) -> ScalarType,
    length: impl Fn(Number) -> ScalarType,
) -> ElementDef {
    let mut def = ElementDef::new(element.name.clone());
    def.count = element.count;
    for (at, property) in element.properties.iter().enumerate() {
        let name = property.used.map_or_else(|| format!("unused {at}"), str::to_owned);
        let data_type = match property.kind {
            PlyKind::Scalar(number) => PropertyType::Scalar(kind(property, number)),
            PlyKind::List(count, item) => PropertyType::List(length(count), kind(property, item)),
        };
        def.properties.add(PropertyDef::new(name, data_type));
    }
    def
}

/// The parser's own type of a number. It has none for 64-bit whole numbers.
pub(super) fn scalar(number: Number) -> ScalarType {
    match number {
        Number::Char => ScalarType::Char,
        Number::UChar => ScalarType::UChar,
        Number::Short => ScalarType::Short,
        Number::UShort => ScalarType::UShort,
        Number::Int => ScalarType::Int,
        Number::UInt => ScalarType::UInt,
        Number::Float => ScalarType::Float,
        Number::Double | Number::Long | Number::ULong => ScalarType::Double,
    }
}

#[derive(Default)]
pub(super) struct PlyVertex {
    pub(super) position: [f64; 3],
    pub(super) normal: [f64; 3],
}

impl PropertyAccess for PlyVertex {
    fn new() -> PlyVertex {
        PlyVertex::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let index = |names: [&str; 3]| names.iter().position(|n| *n == name);
        let slot = match (index(POSITION), index(NORMAL)) {
            (Some(i), _) => self.position.get_mut(i),
            (_, Some(i)) => self.normal.get_mut(i),
            _ => None,
        };
        if let (Some(slot), Some(number)) = (slot, number(&value)) {
            *slot = number;
        }
        PropertyAccessResult::Set
    }
}

impl Element for PlyVertex {}

fn number(value: &Property) -> Option<f64> {
    match *value {
        Property::Char(x) => Some(f64::from(x)),
        Property::UChar(x) => Some(f64::from(x)),
        Property::Short(x) => Some(f64::from(x)),
        Property::UShort(x) => Some(f64::from(x)),
        Property::Int(x) => Some(f64::from(x)),
        Property::UInt(x) => Some(f64::from(x)),
        Property::Float(x) => Some(f64::from(x)),
        Property::Double(x) => Some(x),
        _ => None,
    }
}

/// Takes the place of an index that names no vertex: no file has that number of vertices.
pub(super) const NO_VERTEX: u32 = u32::MAX;

/// A list of indices as whole numbers; `None` if one of them is none.
fn indices(value: Property) -> Option<Vec<u32>> {
    // Below 0 or beyond the range: no vertex.
    let signed = |x: i64| u32::try_from(x).unwrap_or(NO_VERTEX);
    let real = |x: f64| {
        let within = (0.0..=f64::from(u32::MAX)).contains(&x);
        (x.fract() == 0.0).then_some(if within { x as u32 } else { NO_VERTEX })
    };
    match value {
        Property::ListChar(list) => Some(list.into_iter().map(|x| signed(x.into())).collect()),
        Property::ListUChar(list) => Some(list.into_iter().map(u32::from).collect()),
        Property::ListShort(list) => Some(list.into_iter().map(|x| signed(x.into())).collect()),
        Property::ListUShort(list) => Some(list.into_iter().map(u32::from).collect()),
        Property::ListInt(list) => Some(list.into_iter().map(|x| signed(x.into())).collect()),
        Property::ListUInt(list) => Some(list),
        Property::ListFloat(list) => list.into_iter().map(|x| real(x.into())).collect(),
        Property::ListDouble(list) => list.into_iter().map(real).collect(),
        _ => Some(Vec::new()),
    }
}

/// A face, or a strip of triangles.
#[derive(Default)]
pub(super) struct PlyFace {
    pub(super) corners: Vec<u32>,
    /// An index is no whole number.
    fractional: bool,
}

impl PropertyAccess for PlyFace {
    fn new() -> PlyFace {
        PlyFace::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if CORNERS.contains(&name) {
            match indices(value) {
                Some(list) => self.corners = list,
                None => self.fractional = true,
            }
        }
        PropertyAccessResult::Set
    }
}

impl Element for PlyFace {
    fn problem(&self) -> Option<&'static str> {
        self.fractional.then_some("the vertex indices of a face must be whole numbers")
    }
}

/// An element that is read only to get behind it.
pub(super) struct Unused;

impl PropertyAccess for Unused {
    fn new() -> Unused {
        Unused
    }
}

impl Element for Unused {}

/// All that is used of a payload.
#[derive(Default)]
pub(super) struct Elements {
    pub(super) vertices: Vec<PlyVertex>,
    pub(super) faces: Vec<PlyFace>,
    /// Lists of indices in which one that names no vertex ends a strip.
    pub(super) strips: Vec<PlyFace>,
}

//! From the text of an argument to its value. Errors complete clap's "invalid value" line.

use burnish::brdf::{Erratum, Model, Normals, Roughness};
use burnish::math::simd::Isa;
use burnish::picture::{Curve, Format, Tone};
use burnish::progressive::{Params, Strategy};
use burnish::scene::{Axis, Crop};
use burnish::trace::ReuseGroup;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::path::PathBuf;
use std::str::FromStr;

/// `1600x1200`
pub(super) fn size(text: &str) -> Result<[u32; 2], String> {
    let side = 1..=Params::MAX_SIDE;
    let sides =
        text.split_once(['x', 'X']).and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    sides.filter(|[w, h]| side.contains(w) && side.contains(h)).ok_or_else(|| {
        let max = Params::MAX_SIDE;
        format!("expected WIDTHxHEIGHT in pixels, such as 640x480, from 1x1 to {max}x{max}")
    })
}

/// `0.25,0.3,0.5`
pub(super) fn crop(text: &str) -> Result<Crop, String> {
    let expected = || "expected X,Y,SIDE in parts of the picture, such as 0.25,0.3,0.5".to_owned();
    let parts: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let parts: [f64; 3] = parts.and_then(|parts| parts.try_into().ok()).ok_or_else(expected)?;
    Crop::try_from(parts).map_err(|e| e.to_string())
}

/// Roughness as the width alpha.
pub(super) fn alpha(text: &str) -> Result<Roughness, String> {
    Roughness::from_alpha(number(text)?).map_err(|e| e.to_string())
}

/// Roughness as the Phong exponent a_p.
pub(super) fn exponent(text: &str) -> Result<Roughness, String> {
    Roughness::from_exponent(number(text)?).map_err(|e| e.to_string())
}

/// Several alphas with commas between them.
pub(super) fn alphas(text: &str) -> Result<Chosen<Roughness>, String> {
    several(text, alpha)
}

/// Several exponents with commas between them.
pub(super) fn exponents(text: &str) -> Result<Chosen<Roughness>, String> {
    several(text, exponent)
}

fn several<T: PartialEq>(
    text: &str,
    one: impl Fn(&str) -> Result<T, String>,
) -> Result<Chosen<T>, String> {
    let mut all: Vec<T> = Vec::new();
    for part in text.split(',') {
        let value = one(part)?;
        if !all.contains(&value) {
            all.push(value);
        }
    }
    Ok(Chosen(all))
}

/// Exposure in stops.
pub(super) fn exposure(text: &str) -> Result<f32, String> {
    let [low, high] = Tone::EXPOSURE;
    let stops = number(text)?;
    if (low..=high).contains(&stops) {
        Ok(stops)
    } else {
        Err(format!("the exposure must be from {low} to {high} stops"))
    }
}

/// Kd or Ks of all channels.
pub(super) fn reflectance(text: &str) -> Result<f32, String> {
    let value = number(text)?;
    if (0.0..=1.0).contains(&value) {
        Ok(value)
    } else {
        Err("expected a number from 0 to 1".into())
    }
}

/// A relative error, as a part of one or in percent.
pub(super) fn error(text: &str) -> Result<f64, String> {
    let (digits, unit) = text.trim().strip_suffix('%').map_or((text, 1.0), |t| (t, 0.01));
    let error = number::<f64>(digits)? * unit;
    if (1e-6..=1.0).contains(&error) {
        Ok(error)
    } else {
        Err("expected a relative error from 0.000001 to 1, such as 0.02 or 2%".into())
    }
}

/// A part of the whole in percent.
pub(super) fn percent(text: &str) -> Result<f64, String> {
    let percent = number(text)?;
    if (0.0..=100.0).contains(&percent) {
        Ok(percent)
    } else {
        Err("expected a percentage from 0 to 100".into())
    }
}

/// A length of time above 0.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    // The upper end keeps well within what a duration can hold: about 30 years.
    let seconds = number(text)?;
    if seconds > 0.0 && seconds <= 1e9 {
        Ok(seconds)
    } else {
        Err("expected seconds above 0 and at most 1e9".into())
    }
}

/// A length of time that may be none.
pub(super) fn interval(text: &str) -> Result<f64, String> {
    let interval = number(text)?;
    if (0.0..=1e9).contains(&interval) {
        Ok(interval)
    } else {
        Err("expected seconds from 0 to 1e9".into())
    }
}

/// `3/40`, from 1.
pub(super) fn part(text: &str) -> Result<[u64; 2], String> {
    let parts = text.split_once('/').and_then(|(k, n)| Some([k.parse().ok()?, n.parse().ok()?]));
    parts
        .filter(|[number, of]: &[u64; 2]| (1..=*of).contains(number))
        .ok_or_else(|| "expected a part and the number of parts, such as 3/40, from 1".into())
}

/// The number of the pass that a part begins with.
pub(super) fn first_pass(text: &str) -> Result<u64, String> {
    let pass = text.parse().ok().filter(|pass: &u64| {
        pass.is_multiple_of(4) && *pass <= burnish::progressive::Session::MAX_PASSES
    });
    pass.ok_or_else(|| "expected a multiple of 4, the number of a pass".into())
}

/// An OpenEXR file.
pub(super) fn experiment(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match Format::of(&path) {
        Ok(Format::Exr) => Ok(path),
        _ => Err("expected the name of an OpenEXR file, which ends in .exr".into()),
    }
}

/// Radiance of at least 0 in W/(m² sr).
pub(super) fn radiance(text: &str) -> Result<f32, String> {
    let value = number::<f32>(text)?;
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err("expected a finite radiance of at least 0".into())
    }
}

/// A number above 0.
pub(super) fn positive(text: &str) -> Result<f32, String> {
    let value = number::<f32>(text)?;
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err("expected a number above 0".into())
    }
}

/// A file whose name says which kind of picture it is to be.
pub(super) fn picture(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    Format::of(&path).map_err(|e| e.to_string())?;
    Ok(path)
}

/// A model by its lower-case name.
pub(super) fn model() -> impl TypedValueParser<Value = Model> {
    one_of(Model::ALL, Model::name)
}

/// A strategy by its lower-case name.
pub(super) fn strategy() -> impl TypedValueParser<Value = Strategy> {
    one_of(Strategy::ALL, Strategy::name)
}

/// A way to draw normals by its lower-case name.
pub(super) fn normals() -> impl TypedValueParser<Value = Normals> {
    one_of(Normals::ALL, Normals::name)
}

/// An instruction set of this machine by its lower-case name.
pub(super) fn isa() -> impl TypedValueParser<Value = Isa> {
    one_of(Isa::available(), Isa::name)
}

/// A number of paths that share.
pub(super) fn group() -> impl TypedValueParser<Value = ReuseGroup> {
    one_of(ReuseGroup::ALL.into_iter().skip(1), ReuseGroup::name)
}

/// An erratum by its name.
pub(super) fn erratum() -> impl TypedValueParser<Value = Erratum> {
    one_of(Erratum::ALL, Erratum::name)
}

/// Some of a few things, named in one argument.
#[derive(Clone, Debug)]
pub(super) struct Chosen<T>(pub(super) Vec<T>);

/// "all", or names with commas between them.
pub(super) fn chosen<T: Copy + PartialEq + Send + Sync + 'static, const N: usize>(
    all: [T; N],
    name: fn(T) -> &'static str,
) -> impl Fn(&str) -> Result<Chosen<T>, String> + Clone + Send + Sync + 'static {
    let names = all.map(name);
    move |text| {
        if text == "all" {
            return Ok(Chosen(all.to_vec()));
        }
        let one = |part: &str| {
            let place = names.iter().position(|name| *name == part);
            place.map(|i| all[i]).ok_or_else(|| {
                format!("expected all, or some of {} with commas between", names.join(", "))
            })
        };
        let mut chosen: Vec<T> = Vec::new();
        for part in text.split(',') {
            let found = one(part.trim())?;
            if !chosen.contains(&found) {
                chosen.push(found);
            }
        }
        Ok(Chosen(chosen))
    }
}

/// A tone curve by its lower-case name.
pub(super) fn curve() -> impl TypedValueParser<Value = Curve> {
    one_of(Curve::ALL, Curve::name)
}

/// An axis by its name.
pub(super) fn axis() -> impl TypedValueParser<Value = Axis> {
    one_of(Axis::ALL, Axis::name)
}

/// Worker threads; 0 stands for one a core.
pub(super) fn threads() -> impl TypedValueParser<Value = usize> {
    clap::value_parser!(u64).range(0..=MAX_THREADS).map(|threads| threads as usize)
}

/// More would be a slip of the finger.
const MAX_THREADS: u64 = 1024;

/// How many workers that makes.
pub(super) fn worker_count(threads: usize) -> usize {
    if threads > 0 { threads } else { std::thread::available_parallelism().map_or(1, |n| n.get()) }
}

fn one_of<T>(
    all: impl IntoIterator<Item = T>,
    name: impl Fn(T) -> &'static str + Clone + Send + Sync + 'static,
) -> impl TypedValueParser<Value = T>
where
    T: Copy + Send + Sync + 'static,
{
    let all: Vec<T> = all.into_iter().collect();
    PossibleValuesParser::new(all.iter().map(|&x| name(x))).try_map(move |text| {
        all.iter().copied().find(|&x| name(x) == text).ok_or_else(|| format!("unknown: {text}"))
    })
}

fn number<T: FromStr>(text: &str) -> Result<T, String> {
    text.trim().parse().map_err(|_| "expected a number".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        assert_eq!(size("1X32768"), Ok([1, 32_768]));
        for bad in ["", "640", "640x", "x", "0x1", "1x0", "32769x1", "-1x1", "1.5x2", "1x1x1"] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn numbers_out_of_range_say_the_range() {
        for bad in ["0", "1.1", "nan", "inf", "-0.2"] {
            assert!(alpha(bad).unwrap_err().contains("0.0001 to 1"), "{bad}");
        }
        assert!(exponent("-1").is_err() && exponent("1e9").is_err() && exponent("x").is_err());
        for bad in ["31", "-30.5", "NaN", "", "1,5"] {
            assert!(exposure(bad).is_err(), "{bad}");
        }
        for bad in ["0", "-1", "nan", "inf", "1e10"] {
            assert!(seconds(bad).is_err(), "{bad}");
        }
        for bad in ["0", "-1", "nan", "2", "200%", "%", "1e-9"] {
            assert!(error(bad).is_err(), "{bad}");
        }
        for bad in ["", "0.1,", "0.1,x", "0.1,2", "0.1;0.2"] {
            assert!(alphas(bad).is_err(), "{bad}");
        }
        let many = alphas("0.1, 0.2,0.1").unwrap().0;
        assert_eq!(many.iter().map(|r| r.alpha()).collect::<Vec<_>>(), [0.1, 0.2]);
        assert_eq!(exponents("98,10").unwrap().0.len(), 2);
        assert_eq!((error("0.02"), error("2 %"), error("1")), (Ok(0.02), Ok(0.02), Ok(1.0)));
        assert_eq!((exposure("-2.5"), seconds("0.25")), (Ok(-2.5), Ok(0.25)));
    }
}

//! Materials by name: reflectances from measurements, with a roughness to begin with.
//!
//! | name | Kd | Ks | alpha | source |
//! | --- | --- | --- | --- | --- |
//! | gold | 0 | 1.00 0.737 0.359 | 0.2 | n and k of Johnson and Christy 1972 |
//! | copper | 0 | 0.918 0.627 0.517 | 0.25 | the same |
//! | aluminium | 0 | 0.908 0.916 0.923 | 0.3 | n and k of Rakić 1995 |
//! | plastic | 0.50 0.06 0.04 | 0.04 | 0.15 | n = 1.5; Kd is a choice, red |
//! | lacquer | 0.012 0.011 0.011 | 0.044 | 0.08 | n = 1.53, urushi; Kd is a choice, black |
//! | porcelain | 0.74 0.72 0.68 | 0.047 | 0.05 | n = 1.55, feldspar glaze; Kd is a choice, white |
//!
//! Ks is the reflectance at normal incidence: ((n - 1)² + k²) / ((n + 1)² + k²). That of the metals
//! depends on the wavelength: it is weighted with the CIE 1931 colour matching functions under an
//! equal-energy light and taken to linear Rec. 709, each channel over that of a perfect mirror. Gold's
//! red is 1.008 so, beyond what Rec. 709 can show, and given as 1. The tests make the metals' numbers
//! again from n and k, which were compared with the tables of the refractive index database
//! (Polyanskiy 2024), gold and copper by its files `Au/Johnson` and `Cu/Johnson`, aluminium by `Al/Rakic`.

use super::{Material, MaterialError};

/// A named material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// Lower-case name.
    pub name: &'static str,
    /// As a person writes it.
    pub title: &'static str,
    /// Diffuse reflectance, linear Rec. 709.
    pub kd: [f64; 3],
    /// Specular reflectance at normal incidence, linear Rec. 709.
    pub ks: [f64; 3],
    /// A roughness that suits it.
    pub alpha: f64,
    /// Where the reflectances come from.
    pub source: &'static str,
}

/// All of them: metals, then dielectrics.
pub const PRESETS: [Preset; 6] = [
    Preset {
        name: "gold",
        title: "Gold",
        kd: [0.0; 3],
        ks: [1.0, 0.737, 0.359],
        alpha: 0.2,
        source: "n and k measured by Johnson and Christy 1972",
    },
    Preset {
        name: "copper",
        title: "Copper",
        kd: [0.0; 3],
        ks: [0.918, 0.627, 0.517],
        alpha: 0.25,
        source: "n and k measured by Johnson and Christy 1972",
    },
    Preset {
        name: "aluminium",
        title: "Aluminium",
        kd: [0.0; 3],
        ks: [0.908, 0.916, 0.923],
        alpha: 0.3,
        source: "n and k by Raki\u{107} 1995",
    },
    Preset {
        name: "plastic",
        title: "Plastic",
        kd: [0.50, 0.06, 0.04],
        ks: [0.04; 3],
        alpha: 0.15,
        source: "n = 1.5; the red is a choice",
    },
    Preset {
        name: "lacquer",
        title: "Lacquer",
        kd: [0.012, 0.011, 0.011],
        ks: [0.044; 3],
        alpha: 0.08,
        source: "n = 1.53, urushi; the black is a choice",
    },
    Preset {
        name: "porcelain",
        title: "Porcelain",
        kd: [0.74, 0.72, 0.68],
        ks: [0.047; 3],
        alpha: 0.05,
        source: "n = 1.55, a feldspar glaze; the white is a choice",
    },
];

impl Preset {
    /// The one of this name.
    pub fn named(name: &str) -> Option<&'static Preset> {
        PRESETS.iter().find(|preset| preset.name == name)
    }

    /// The material, called by the preset's title.
    pub fn material(&self) -> Result<Material, MaterialError> {
        let mut material = Material::reflecting(self.title, self.kd, self.ks, 0.0)?;
        material.roughness = crate::brdf::Roughness::from_alpha(self.alpha)?;
        Ok(material)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_a_material_that_gives_back_no_more_than_it_gets() {
        for (i, preset) in PRESETS.iter().enumerate() {
            let material = preset.material().unwrap();
            assert!((material.roughness.alpha() - preset.alpha).abs() < 1e-12);
            assert!(!material.emits());
            for (kd, ks) in preset.kd.iter().zip(preset.ks) {
                assert!(kd + ks <= 1.0 && ks > 0.0, "{}", preset.name);
            }
            assert_eq!(Preset::named(preset.name), Some(preset));
            assert!(PRESETS[..i].iter().all(|p| p.name != preset.name && p.title != preset.title));
        }
    }

    /// Reflectance at normal incidence.
    fn reflectance(n: f64, k: f64) -> f64 {
        ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k)
    }

    #[test]
    fn dielectrics_have_the_reflectance_of_their_index() {
        for (name, n) in [("plastic", 1.5), ("lacquer", 1.53), ("porcelain", 1.55)] {
            let ks = Preset::named(name).unwrap().ks;
            assert!(ks.iter().all(|ks| (ks - reflectance(n, 0.0)).abs() < 5e-4), "{name}");
        }
    }

    /// Photon energy in eV, n of gold and k of it, n of copper and k of it.
    const JOHNSON_CHRISTY: [[f64; 5]; 16] = [
        [1.51, 0.16, 5.083, 0.26, 5.180],
        [1.64, 0.14, 4.542, 0.24, 4.665],
        [1.76, 0.13, 4.103, 0.21, 4.205],
        [1.88, 0.14, 3.697, 0.22, 3.747],
        [2.01, 0.21, 3.272, 0.30, 3.205],
        [2.14, 0.29, 2.863, 0.70, 2.704],
        [2.26, 0.43, 2.455, 1.02, 2.577],
        [2.38, 0.62, 2.081, 1.18, 2.608],
        [2.50, 1.04, 1.833, 1.22, 2.564],
        [2.63, 1.31, 1.849, 1.25, 2.483],
        [2.75, 1.38, 1.914, 1.24, 2.397],
        [2.88, 1.45, 1.948, 1.25, 2.305],
        [3.00, 1.46, 1.958, 1.28, 2.207],
        [3.12, 1.47, 1.952, 1.32, 2.116],
        [3.25, 1.46, 1.933, 1.33, 2.045],
        [3.37, 1.48, 1.895, 1.36, 1.975],
    ];
    /// Photon energy in eV, n and k of aluminium.
    const RAKIC: [[f64; 3]; 12] = [
        [1.56, 2.7675, 8.3866],
        [1.60, 2.6154, 8.4914],
        [1.70, 2.1606, 8.3565],
        [1.80, 1.8301, 8.0601],
        [1.90, 1.5724, 7.7354],
        [2.00, 1.3660, 7.4052],
        [2.20, 1.0728, 6.7839],
        [2.40, 0.8734, 6.2418],
        [2.60, 0.7278, 5.7781],
        [2.80, 0.6079, 5.3676],
        [3.00, 0.5214, 5.0008],
        [3.40, 0.3988, 4.3957],
    ];

    /// CIE 1931 by the fit of Wyman, Sloan and Shirley (JCGT 2013); the wavelength in nm.
    fn cie(wavelength: f64) -> [f64; 3] {
        let bell = |middle: f64, [below, above]: [f64; 2]| {
            let width = if wavelength < middle { below } else { above };
            (-0.5 * ((wavelength - middle) * width).powi(2)).exp()
        };
        [
            0.362 * bell(442.0, [0.0624, 0.0374]) + 1.056 * bell(599.8, [0.0264, 0.0323])
                - 0.065 * bell(501.1, [0.0490, 0.0382]),
            0.821 * bell(568.8, [0.0213, 0.0247]) + 0.286 * bell(530.9, [0.0613, 0.0322]),
            1.217 * bell(437.0, [0.0845, 0.0278]) + 0.681 * bell(459.0, [0.0385, 0.0725]),
        ]
    }

    fn rec709([x, y, z]: [f64; 3]) -> [f64; 3] {
        [
            3.2404542 * x - 1.5371385 * y - 0.4985314 * z,
            -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
            0.0556434 * x - 0.2040259 * y + 1.0572252 * z,
        ]
    }

    /// What a spectrum of reflectances looks like, over what a perfect mirror does.
    fn colour(at: impl Fn(f64) -> f64) -> [f64; 3] {
        let (mut sum, mut white) = ([0.0; 3], [0.0; 3]);
        for step in 0..=80 {
            let wavelength = 380.0 + 5.0 * f64::from(step);
            let r = at(1239.84 / wavelength);
            for (c, weight) in cie(wavelength).into_iter().enumerate() {
                sum[c] += r * weight;
                white[c] += weight;
            }
        }
        let (sum, white) = (rec709(sum), rec709(white));
        std::array::from_fn(|c| (sum[c] / white[c]).min(1.0))
    }

    /// Reflectance at an energy between those of the table.
    fn between(table: &[[f64; 3]], energy: f64) -> f64 {
        let place = table.partition_point(|row| row[0] < energy).clamp(1, table.len() - 1);
        let (a, b) = (table[place - 1], table[place]);
        let t = ((energy - a[0]) / (b[0] - a[0])).clamp(0.0, 1.0);
        reflectance(a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2]))
    }

    #[test]
    fn metals_have_the_colour_of_their_measured_indices() {
        let gold = JOHNSON_CHRISTY.map(|[e, n, k, ..]| [e, n, k]);
        let copper = JOHNSON_CHRISTY.map(|[e, .., n, k]| [e, n, k]);
        for (name, table) in
            [("gold", &gold[..]), ("copper", &copper[..]), ("aluminium", &RAKIC[..])]
        {
            let made = colour(|energy| between(table, energy));
            let ks = Preset::named(name).unwrap().ks;
            for (made, ks) in made.iter().zip(ks) {
                assert!((made - ks).abs() < 2e-3, "{name}: {made} and {ks}");
            }
        }
    }
}

//! The first waist: a part as a stack of plane sections, whatever it was read from.

use crate::poly::Region;

/// One printed layer: its section, taken at the middle of its height.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    z_top_mm: f64,
    height_mm: f64,
    region: Region,
}

impl Layer {
    /// A layer that ends at `z_top_mm` above the plate and is `height_mm` high; `None` unless both are finite,
    /// the height is positive and the layer starts at or above the plate (within 1e-6 mm).
    pub fn new(z_top_mm: f64, height_mm: f64, region: Region) -> Option<Self> {
        let sound = z_top_mm.is_finite() && height_mm > 0.0 && z_top_mm - height_mm > -1e-6;
        sound.then_some(Self { z_top_mm, height_mm, region })
    }

    /// Height of the nozzle above the plate while this layer is printed, mm.
    pub fn z_top_mm(&self) -> f64 {
        self.z_top_mm
    }

    /// Thickness of the layer, mm.
    pub fn height_mm(&self) -> f64 {
        self.height_mm
    }

    /// The section at the middle of the layer's height.
    pub fn region(&self) -> &Region {
        &self.region
    }
}

/// A part as layers from the plate upwards. Invariant: `z_top_mm` rises strictly.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LayerStack {
    layers: Vec<Layer>,
}

impl LayerStack {
    /// The stack of these layers; `None` unless each ends higher than the one before.
    pub fn new(layers: Vec<Layer>) -> Option<Self> {
        layers.windows(2).all(|w| w[0].z_top_mm < w[1].z_top_mm).then_some(Self { layers })
    }

    /// The layers, lowest first.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Volume in mm3: the sum of area times height.
    pub fn volume_mm3(&self) -> f64 {
        self.layers.iter().map(|l| l.region.area_mm2() * l.height_mm).sum()
    }
}

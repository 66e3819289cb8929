//! The part as a stack of plane sections, independent of the file type it was read from.
//!
//! A mesh, a scan, a drawing and a photograph all become a [`LayerStack`]; walls, infill and
//! supports use nothing else of the part. Heights are mm above the plate, regions are in part
//! coordinates (mm). The stack can be kept or sent to another machine as bytes:
//! [`LayerStack::to_bytes`], format in [`encoding`].

pub mod encoding;

pub use encoding::LayerStackError;

use crate::poly::Region;

/// One printed layer: its section, taken at the middle of its height.
///
/// ```
/// use grainpath_core::{DVec2, Layer, Region};
///
/// let section = Region::rectangle(DVec2::ZERO, DVec2::new(20.0, 5.0));
/// let layer = Layer::new(0.2, 0.2, section.clone()).expect("it stands on the plate");
/// assert_eq!(layer.region().area_mm2(), 100.0);
/// assert!(Layer::new(0.1, 0.2, section).is_none(), "it would begin below the plate");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    z_top_mm: f64,
    height_mm: f64,
    region: Region,
}

impl Layer {
    /// A layer whose top is `z_top_mm` above the plate and which is `height_mm` high. `None` if a value is
    /// not finite, the height is not positive, or the layer starts more than 1e-6 mm below the
    /// plate.
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

/// A part as layers from the plate upwards. Invariant: each layer has a larger `z_top_mm` than the one below.
///
/// ```
/// use grainpath_core::{DVec2, Layer, LayerStack, Region};
///
/// let section = Region::rectangle(DVec2::ZERO, DVec2::new(20.0, 5.0));
/// let layer = |top_mm| Layer::new(top_mm, 0.2, section.clone()).unwrap();
/// let stack = LayerStack::new(vec![layer(0.2), layer(0.4)]).expect("heights rise");
/// assert_eq!(stack.volume_mm3(), 40.0);
/// assert!(LayerStack::new(vec![layer(0.4), layer(0.2)]).is_none());
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LayerStack {
    layers: Vec<Layer>,
}

impl LayerStack {
    /// A stack of layers; `None` unless the top of each layer is higher than that of the previous one.
    pub fn new(layers: Vec<Layer>) -> Option<Self> {
        layers.windows(2).all(|w| w[0].z_top_mm < w[1].z_top_mm).then_some(Self { layers })
    }

    /// The layers, lowest first.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Volume in mm3: the sum of area times height over all layers.
    pub fn volume_mm3(&self) -> f64 {
        self.layers.iter().map(|l| l.region.area_mm2() * l.height_mm).sum()
    }
}

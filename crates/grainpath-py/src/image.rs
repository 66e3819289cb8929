//! Makes a photograph from an array of the caller.

use grainpath_core::image::{Image, ImageFormat, Samples};
use grainpath_imaging::photo::Photo;
use numpy::PyReadonlyArray3;
use pyo3::prelude::*;

use crate::worker::{self, Caller};

/// A photograph in grey.
#[pyclass(frozen, module = "grainpath._grainpath")]
pub(crate) struct ImageData {
    /// The photograph.
    pub photo: Photo,
}

/// Samples `(rows, columns, channels)`.
#[derive(FromPyObject)]
pub(crate) enum Pixels<'py> {
    /// 8 bits.
    U8(PyReadonlyArray3<'py, u8>),
    /// 16 bits.
    U16(PyReadonlyArray3<'py, u16>),
    /// Floats, whose lowest value is black and whose highest is white.
    F32(PyReadonlyArray3<'py, f32>),
}

/// Makes a photograph from contiguous samples, rows from the top. Errors call it `name`.
#[pyfunction]
pub(crate) fn image_from_array(py: Python<'_>, name: String, pixels: Pixels<'_>) -> PyResult<ImageData> {
    let (shape, samples) = match &pixels {
        Pixels::U8(a) => (a.as_array().dim(), Samples::U8(a.as_slice()?.to_vec())),
        Pixels::U16(a) => (a.as_array().dim(), Samples::U16(a.as_slice()?.to_vec())),
        Pixels::F32(a) => (a.as_array().dim(), Samples::F32(a.as_slice()?.to_vec())),
    };
    let (height, width, channels) = shape;
    worker::run(py, &Caller::default(), move |_, _| {
        let image = Image { format: ImageFormat::Png, width, height, channels, samples };
        Ok(ImageData { photo: Photo::from_image(name, image) })
    })
}

//! A contact sheet: slices of a scan side by side.

/// Slices in a row of the sheet. Twenty tiles in rows of five fit a screen without scrolling. Source: chosen by eye; only
/// the picture depends on it.
const COLUMNS: usize = 5;
/// Source: chosen by eye; only the picture depends on it.
const SHOWN: usize = 20;
/// Longest side of a slice on the sheet, px. Longer slices are shrunk.
/// Source: chosen by eye; only the picture depends on it.
const TILE_PX: usize = 240;

/// Slices of a scan, shrunk as they arrive.
#[derive(Debug, Clone)]
pub struct ContactSheet {
    size: [usize; 3],
    shrink: usize,
    tiles: Vec<Vec<f32>>,
}

impl ContactSheet {
    /// A sheet for a scan of this size: columns, rows, slices.
    pub fn new(size: [usize; 3]) -> Self {
        // The factor is a whole number, so that every pixel of a tile is the mean of equally many voxels.
        let shrink = size[0].max(size[1]).div_ceil(TILE_PX).max(1);
        Self { size, shrink, tiles: Vec::new() }
    }

    fn tile(&self) -> (usize, usize) {
        (self.size[0].div_ceil(self.shrink), self.size[1].div_ceil(self.shrink))
    }

    /// Adds slice `k` if it is one of the evenly spaced slices that the sheet shows. NaN stands for no value and is black.
    pub fn add(&mut self, k: usize, values: &[f32]) {
        let n = self.size[2];
        let shown = SHOWN.min(n);
        // The scan is cut into `shown` equal parts, whose middle slices are shown. The outermost slices are often empty.
        if self.tiles.len() >= shown || k != (2 * self.tiles.len() + 1) * n / (2 * shown) {
            return;
        }
        let (w, h) = self.tile();
        let (nx, ny) = (self.size[0], self.size[1]);
        let mut tile = Vec::with_capacity(w * h);
        for j in 0..h {
            for i in 0..w {
                let (x, y) = (i * self.shrink, j * self.shrink);
                let (x1, y1) = ((x + self.shrink).min(nx), (y + self.shrink).min(ny));
                let sum: f32 = (y..y1).flat_map(|y| &values[y * nx + x..y * nx + x1]).sum();
                tile.push(sum / ((x1 - x) * (y1 - y)) as f32);
            }
        }
        self.tiles.push(tile);
    }

    /// The sheet as PNG with `low` as black and `high` as white. The first slice is at the top left.
    pub fn png(&self, low: f32, high: f32) -> Vec<u8> {
        let (w, h) = self.tile();
        let columns = COLUMNS.min(self.tiles.len()).max(1);
        let rows = self.tiles.len().div_ceil(columns).max(1);
        let (width, height) = (columns * (w + 4) + 4, rows * (h + 4) + 4);
        // A dark grey shows the border of tiles that are black at their edges.
        let mut pixels = vec![40u8; width * height];
        let scale = 255.0 / (high - low).max(f32::MIN_POSITIVE);
        for (k, tile) in self.tiles.iter().enumerate() {
            let (x0, y0) = (4 + (k % columns) * (w + 4), 4 + (k / columns) * (h + 4));
            for (j, row) in tile.chunks_exact(w).enumerate() {
                let at = (y0 + j) * width + x0;
                for (out, v) in pixels[at..at + w].iter_mut().zip(row) {
                    // `as` saturates, so values outside the range become black or white, and it turns NaN into 0.
                    *out = ((v - low) * scale) as u8;
                }
            }
        }
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(png::BitDepth::Eight);
        let written = encoder.write_header().and_then(|mut w| w.write_image_data(&pixels));
        written.expect("writing to memory cannot fail");
        bytes
    }
}

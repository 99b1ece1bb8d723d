//! Pictures of the sky as files.

use crate::asset::Image;
use crate::color::Rgb;

/// A picture for a renderer whose first and last rows lie on the poles, as a PFM file. Ours lie half a row off them, so
/// there are two rows for each of ours and one more: between them is what is between ours.
pub(super) fn with_rows_on_poles(image: &Image) -> Vec<u8> {
    let (width, height) = (image.width(), image.height());
    let mut file = format!("PF\n{width} {}\n-1.0\n", 2 * height + 1).into_bytes();
    // The format has its rows from the bottom.
    for row in (0..=2 * height).rev() {
        let (above, below) = (row.saturating_sub(1) / 2, (row / 2).min(height - 1));
        for column in 0..width {
            let color: Rgb = 0.5 * (image.pixel(column, above) + image.pixel(column, below));
            color.to_array().iter().for_each(|channel| file.extend((*channel as f32).to_le_bytes()));
        }
    }
    file
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_lie_on_the_poles_and_between_ours() {
        let image = Image::new(1, 2, vec![[1.0, 2.0, 3.0], [5.0, 6.0, 7.0]]).unwrap();
        let file = with_rows_on_poles(&image);
        let pixels = file.strip_prefix(b"PF\n1 5\n-1.0\n").unwrap();
        let red: Vec<f32> = pixels.chunks(12).map(|p| f32::from_le_bytes([p[0], p[1], p[2], p[3]])).collect();
        assert_eq!(red, [5.0, 5.0, 3.0, 1.0, 1.0]);
    }
}

//! Films of made-up pictures, read back.

use std::io::BufReader;

use image::AnimationDecoder;
use image::codecs::png::PngDecoder;

use super::*;
use crate::image::metrics::psnr_8bit;

const SIZE: [u32; 2] = [23, 17];

/// Outputs in all formats of this build.
fn outputs() -> Vec<&'static str> {
    let mp4 = cfg!(feature = "mp4").then_some("film.mp4");
    ["film.png", "film.gif", "film/"]
        .into_iter()
        .chain(mp4)
        .collect()
}

fn shape(pictures: u32) -> FilmShape {
    FilmShape {
        size: SIZE,
        pictures,
        fps: 8.0,
        hold: 1.5,
    }
}

/// A bright square that moves over a background of `colors` colors.
fn picture(n: u32, colors: u32) -> Vec<[u8; 3]> {
    let [w, h] = SIZE;
    let pixel = |x: u32, y: u32| {
        if x / 4 == n && y > 5 {
            return [255, 220, n as u8];
        }
        let v = (x + w * y) % colors;
        [v as u8, (v / 2) as u8, (v / 256) as u8]
    };
    (0..h)
        .flat_map(|y| (0..w).map(move |x| pixel(x, y)))
        .collect()
}

fn write(path: &Path, pictures: &[Vec<[u8; 3]>]) {
    let mut film = Film::create(path, shape(pictures.len() as u32)).unwrap();
    for picture in pictures {
        film.add(picture).unwrap();
    }
    film.finish().unwrap();
}

/// Pictures of an animated PNG with their durations in milliseconds.
fn read_png(path: &Path) -> Vec<(Vec<[u8; 3]>, u32)> {
    let decoder = PngDecoder::new(BufReader::new(std::fs::File::open(path).unwrap())).unwrap();
    let frames = decoder.apng().unwrap().into_frames();
    let read = |frame: image::ImageResult<image::Frame>| {
        let frame = frame.unwrap();
        let (ms, of) = frame.delay().numer_denom_ms();
        let pixels = frame.buffer().pixels().map(|p| [p[0], p[1], p[2]]);
        (pixels.collect(), ms / of)
    };
    frames.map(read).collect()
}

/// Pictures of a GIF, each laid over the one before, with their durations in milliseconds.
fn read_gif(path: &Path) -> Vec<(Vec<[u8; 3]>, u32)> {
    let mut options = ::gif::DecodeOptions::new();
    options.set_color_output(::gif::ColorOutput::RGBA);
    let mut decoder = options
        .read_info(std::fs::File::open(path).unwrap())
        .unwrap();
    let mut canvas = vec![[1, 2, 3]; (SIZE[0] * SIZE[1]) as usize];
    let mut read = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        for (pixel, rgba) in canvas.iter_mut().zip(frame.buffer.chunks_exact(4)) {
            if rgba[3] > 0 {
                pixel.copy_from_slice(&rgba[..3]);
            }
        }
        read.push((canvas.clone(), 10 * u32::from(frame.delay)));
    }
    read
}

#[test]
fn ok_png_and_gif_of_few_colors_give_back_the_same_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let pictures: Vec<_> = (0..4).map(|n| picture(n, 200)).collect();
    for (name, read, durations) in [
        ("a.png", read_png as fn(&Path) -> _, [125, 125, 125, 1625]),
        // Whole hundredths of a second that sum up to the right time.
        ("a.GIF", read_gif, [130, 120, 130, 1620]),
    ] {
        let path = folder.path().join(name);
        write(&path, &pictures);
        let read: Vec<(Vec<[u8; 3]>, u32)> = read(&path);
        assert_eq!(read.iter().map(|r| r.1).collect::<Vec<_>>(), durations);
        let read: Vec<_> = read.into_iter().map(|r| r.0).collect();
        assert!(read == pictures, "{name}");
        assert!(read[0] != pictures[1], "{name}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn ok_gif_of_many_colors_stays_near_and_what_stands_still_does_not_flicker() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gif");
    let pictures: Vec<_> = (0..3).map(|n| picture(n, 350)).collect();
    write(&path, &pictures);
    let read = read_gif(&path);
    for (picture, (read, _)) in pictures.iter().zip(&read) {
        let db = psnr_8bit(picture.as_flattened(), read.as_flattened());
        assert!(db > 35.0, "{db} dB");
    }
    // Behind the last place of the square.
    let still = |n: usize| n % 23 >= 12;
    for (n, &pixel) in read[0].0.iter().enumerate().filter(|(n, _)| still(*n)) {
        assert_eq!(pixel, read[2].0[n]);
    }
}

#[test]
fn ok_gif_keeps_the_color_of_few_pixels_among_many_others() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gif");
    // 390 reds and one pixel of ink.
    let mut picture: Vec<[u8; 3]> = (0..391u32)
        .map(|n| [255 - (n / 40) as u8, (n % 40) as u8, 0])
        .collect();
    picture[200] = [28; 3];
    write(&path, std::slice::from_ref(&picture));
    let read = &read_gif(&path)[0].0;
    assert_eq!(read[200], [28; 3]);
    assert!(read != &picture, "255 colors were enough");
}

#[test]
fn ok_folder_of_pictures_replaces_an_older_film_but_no_longer_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film");
    let pictures: Vec<_> = (0..3).map(|n| picture(n, 350)).collect();
    write(&folder.path().join("film/"), &pictures[1..]);
    // Now it is there, no stroke is needed.
    write(&path, &pictures);
    for (n, wanted) in pictures.iter().enumerate() {
        let read = image::open(path.join(format!("frame_000{n}.png"))).unwrap();
        assert_eq!(read.into_rgb8().as_raw(), wanted.as_flattened());
    }
    assert_eq!(std::fs::read_dir(&path).unwrap().count(), 3);
    let error = Film::create(&path, shape(2)).err().unwrap().to_string();
    assert!(error.contains("frame_0002.png"), "{error}");
}

#[test]
fn unfinished_films_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    for name in outputs() {
        let path = folder.path().join(name);
        for finish in [false, true] {
            let mut film = Film::create(&path, shape(3)).unwrap();
            film.add(&picture(0, 9)).unwrap();
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
            if finish {
                let error = film.finish().unwrap_err().to_string();
                assert!(error.contains("1 images instead of 3"), "{error}");
            } else {
                drop(film);
            }
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        }
        // The twin: whole films stay.
        write(&path, &[picture(0, 9)]);
        assert!(path.exists(), "{name}");
        std::fs::remove_file(&path)
            .or_else(|_| std::fs::remove_dir_all(&path))
            .unwrap();
    }
}

#[test]
fn err_pictures_of_another_size() {
    let folder = tempfile::tempdir().unwrap();
    for name in outputs() {
        let mut film = Film::create(&folder.path().join(name), shape(1)).unwrap();
        assert!(film.add(&picture(0, 9)[1..]).is_err(), "{name}");
    }
}

#[test]
fn err_unknown_formats_and_places() {
    for unknown in ["a.avi", "a", ".png", "a.exr"] {
        let error = FilmFormat::from_path(Path::new(unknown)).unwrap_err();
        assert!(error.to_string().contains("DIR/"), "{error}");
    }
    for gone in ["/no/such/a.png", "/no/such/a.gif", "/no/such/a/"] {
        let error = Film::create(Path::new(gone), shape(1)).err().unwrap();
        assert!(error.to_string().contains(gone), "{error}");
    }
}

#[cfg(not(feature = "mp4"))]
#[test]
fn err_mp4_says_how_to_get_it() {
    let error = FilmFormat::from_path(Path::new("a.mp4")).unwrap_err();
    for word in ["a.mp4", "--features mp4", "C++", "patents", ".png"] {
        assert!(error.to_string().contains(word), "{error}");
    }
}

#[cfg(feature = "mp4")]
mod mp4 {
    use super::*;

    /// The content of the first box of a kind among boxes one after another.
    fn find<'a>(mut boxes: &'a [u8], kind: &[u8]) -> &'a [u8] {
        loop {
            let length = u32::from_be_bytes(boxes[..4].try_into().unwrap()) as usize;
            if &boxes[4..8] == kind {
                return &boxes[8..length];
            }
            boxes = &boxes[length..];
        }
    }

    fn number(bytes: &[u8], at: usize) -> u32 {
        u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap())
    }

    #[test]
    fn ok_container_holds_each_picture_and_the_last_one_longer() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mp4");
        for pictures in [1, 5] {
            let made: Vec<_> = (0..pictures).map(|n| picture(n, 350)).collect();
            write(&path, &made);
            let file = std::fs::read(&path).unwrap();
            assert_eq!(&file[4..8], b"ftyp");
            let track = find(find(&file, b"moov"), b"trak");
            // Width and height in 16.16, padded to even numbers.
            let header = find(track, b"tkhd");
            let size = [8, 4].map(|back| number(header, header.len() - back) >> 16);
            assert_eq!(size, [24, 18]);
            let table = find(find(find(track, b"mdia"), b"minf"), b"stbl");
            let samples = number(find(table, b"stsz"), 8);
            // 1.5 s at 8 pictures a second.
            assert_eq!(samples, pictures + 12);
        }
    }

    #[test]
    fn err_sizes_beyond_the_format() {
        for size in [[8, 100], [4000, 100], [3000, 2500]] {
            let film = Film::create(Path::new("a.mp4"), FilmShape { size, ..shape(1) });
            let error = film.err().unwrap().to_string();
            assert!(error.contains("3840x2160"), "{error}");
        }
    }
}

//! The text headers of SEG-Y: 40 lines of 80 letters, in EBCDIC or ASCII.

/// Bytes of a text header.
pub(super) const LENGTH: usize = 3200;
const LINE: usize = 80;

/// ASCII of the letters of EBCDIC (code page 37); a question mark stands for what has none.
const LETTERS: [&[u8; 64]; 4] = [
    b"????????????????????????????????????????????????????????????????",
    b" ??????????.<(+|&?????????!$*);?-/?????????,%_>??????????`:#@'=\"",
    b"?abcdefghi???????jklmnopqr???????~stuvwxyz??????^?????????[]????",
    b"{ABCDEFGHI??????}JKLMNOPQR??????\\?STUVWXYZ??????0123456789??????",
];

fn to_ascii(byte: u8) -> u8 {
    LETTERS[usize::from(byte / 64)][usize::from(byte % 64)]
}

fn to_ebcdic(letter: u8) -> u8 {
    let all = LETTERS.iter().flat_map(|row| row.iter());
    let found = all.zip(0..=u8::MAX).find(|(known, _)| **known == letter);
    found.map_or(0x40, |(_, byte)| byte)
}

fn is_print(byte: u8) -> bool {
    byte == b' ' || byte.is_ascii_graphic()
}

/// True where most bytes are letters of EBCDIC, and fewer are of ASCII.
pub(super) fn is_ebcdic(header: &[u8]) -> bool {
    let count = |is: fn(u8) -> bool| header.iter().filter(|byte| is(**byte)).count();
    let is_letter = |byte| byte == 0x40 || (byte > 0x40 && to_ascii(byte) != b'?');
    count(is_letter) > count(is_print)
}

/// True where nearly all bytes are letters, of one code or the other.
pub(super) fn is_text(header: &[u8]) -> bool {
    let is_ebcdic = is_ebcdic(header);
    let is_letter = |byte: &&u8| match is_ebcdic {
        true => to_ascii(**byte) != b'?',
        false => is_print(**byte),
    };
    header.iter().filter(is_letter).count() * 10 >= header.len() * 9
}

/// The lines of a header, without blanks at their ends and without empty lines at the end.
pub(super) fn lines(header: &[u8]) -> Vec<String> {
    let is_ebcdic = is_ebcdic(header);
    let letter = |byte: &u8| match (is_ebcdic, *byte) {
        (true, byte) => char::from(to_ascii(byte)),
        (false, byte) if is_print(byte) => char::from(byte),
        (false, 0) => ' ',
        (false, _) => '?',
    };
    let lines = header
        .chunks(LINE)
        .map(|line| line.iter().map(letter).collect::<String>());
    let mut lines: Vec<_> = lines.map(|line| line.trim_end().to_owned()).collect();
    while lines.last().is_some_and(String::is_empty) {
        lines.pop();
    }
    lines
}

/// A header of `text` in EBCDIC: its lines, cut where they are too long or too many.
pub(super) fn header(text: &str) -> Vec<u8> {
    let mut bytes = vec![to_ebcdic(b' '); LENGTH];
    let mut lines = text.lines();
    for (n, line) in bytes.chunks_mut(LINE).enumerate() {
        let written = format!("C{:2} {}", n + 1, lines.next().unwrap_or_default());
        for (byte, letter) in line.iter_mut().zip(written.bytes()) {
            *byte = to_ebcdic(letter);
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_of_both_codes() {
        let known = [
            (0xc3, b'C'),
            (0x40, b' '),
            (0xf1, b'1'),
            (0x81, b'a'),
            (0xe9, b'Z'),
            (0x4b, b'.'),
        ];
        for (byte, letter) in known {
            assert_eq!((to_ascii(byte), to_ebcdic(letter)), (byte_as(letter), byte));
        }
        fn byte_as(letter: u8) -> u8 {
            letter
        }
        let written = header("a survey\nof two lines");
        assert!(is_text(&written) && is_ebcdic(&written));
        let lines = lines(&written);
        assert_eq!(
            (lines[0].as_str(), lines[1].as_str()),
            ("C 1 a survey", "C 2 of two lines")
        );
        let ascii: Vec<u8> = written.iter().map(|byte| to_ascii(*byte)).collect();
        assert!(is_text(&ascii) && !is_ebcdic(&ascii));
        assert_eq!(super::lines(&ascii), lines);
        let noise: Vec<u8> = (0..LENGTH).map(|n| (n * 7 % 256) as u8).collect();
        assert!(!is_text(&noise));
    }
}

//! Tokens, records and keywords of decks: the grammar, and the two searches that skip over text.
//!
//! A record is a list of items ended by `/`; the rest of that line is comment. An item is a word,
//! a text in quotes, a default (`*`, `3*`) or a repeated word (`3*0.25`). `--` starts a comment
//! that runs to the end of its line. Lines end with LF, CR LF or a lone CR.

use nom::branch::alt;
use nom::bytes::complete::{tag, take, take_till, take_while1};
use nom::character::complete::{char, digit1};
use nom::combinator::{all_consuming, recognize, rest, value};
use nom::multi::many0_count;
use nom::sequence::{delimited, terminated};
use nom::{FindSubstring, IResult, Parser};

use crate::error::ErrorKind;

/// Most items of a record read item by item, so that repeat counts stay harmless.
const MOST_ITEMS: usize = 1000;
/// Longest word taken for a keyword.
const LONGEST_KEYWORD: usize = 32;

/// What is wrong at an offset of a text.
#[derive(Debug)]
pub(super) struct Mistake {
    pub(super) kind: ErrorKind,
    pub(super) at: usize,
    pub(super) message: String,
}

impl Mistake {
    pub(super) fn new(kind: ErrorKind, at: usize, message: impl Into<String>) -> Self {
        let message = message.into();
        Self { kind, at, message }
    }

    /// The same mistake in a text that begins `by` bytes earlier.
    pub(super) fn moved(mut self, by: usize) -> Self {
        self.at += by;
        self
    }
}

/// A token of a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Token<'a> {
    /// A bare word or number, repeat count included.
    Word(&'a [u8]),
    /// What stands between quotes.
    Text(&'a [u8]),
    /// The end of the record.
    Slash,
}

/// An item of a record with its offset.
#[derive(Debug, Clone, Copy)]
pub(super) struct Item<'a> {
    pub(super) at: usize,
    /// The word or text without quotes and blanks around it; `None` where it is left to its default.
    pub(super) text: Option<&'a [u8]>,
}

/// A keyword at the start of a line.
#[derive(Debug)]
pub(super) struct Keyword {
    /// In upper case.
    pub(super) name: String,
    pub(super) at: usize,
    /// Offset behind it.
    pub(super) end: usize,
    /// True when nothing but a comment, or a line that is drawn, follows on its line.
    pub(super) alone: bool,
}

/// A place in a text from which tokens are read.
#[derive(Clone)]
pub(super) struct Cursor<'a> {
    pub(super) text: &'a [u8],
    pub(super) at: usize,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(text: &'a [u8], at: usize) -> Self {
        Self { text, at }
    }

    fn remaining(&self) -> &'a [u8] {
        self.text.get(self.at..).unwrap_or_default()
    }

    /// Moves to the next byte that is neither blank nor comment; false at the end of the text.
    pub(super) fn skip_blank(&mut self) -> bool {
        if let Ok((behind, _)) = blank(self.remaining()) {
            self.at = self.text.len() - behind.len();
        }
        self.at < self.text.len()
    }

    /// The next token and its offset; `None` at the end of the text.
    pub(super) fn token(&mut self) -> Result<Option<(usize, Token<'a>)>, Mistake> {
        if !self.skip_blank() {
            return Ok(None);
        }
        let start = self.at;
        let (behind, token) = token(self.remaining()).map_err(|_| {
            Mistake::new(
                ErrorKind::Malformed,
                start,
                "a quote is not closed on its line",
            )
        })?;
        self.at = self.text.len() - behind.len();
        Ok(Some((start, token)))
    }

    /// The items up to the closing `/`, and moves behind its line.
    pub(super) fn record(&mut self) -> Result<Vec<Item<'a>>, Mistake> {
        let (start, mut items) = (self.at, Vec::new());
        while items.len() <= MOST_ITEMS {
            match self.token()? {
                None => return Err(self.unended(start)),
                Some((_, Token::Slash)) => {
                    self.at = line_end(self.text, self.at);
                    return Ok(items);
                }
                Some((at, Token::Text(text))) => {
                    let text = Some(text.trim_ascii());
                    items.push(Item { at, text });
                }
                Some((at, Token::Word(word))) => push_repeated(&mut items, at, word)?,
            }
        }
        Err(Mistake::new(
            ErrorKind::Malformed,
            start,
            "the record has too many items; is its closing / missing?",
        ))
    }

    fn unended(&self, start: usize) -> Mistake {
        let start = start.min(self.text.len());
        Mistake::new(
            ErrorKind::Truncated,
            start,
            "the file ends before the closing / of this record",
        )
    }
}

fn push_repeated<'a>(items: &mut Vec<Item<'a>>, at: usize, word: &'a [u8]) -> Result<(), Mistake> {
    let (count, written) = repeat(word).map_err(|mistake| mistake.moved(at))?;
    let text = (!written.is_empty()).then_some(written);
    let room = MOST_ITEMS + 1 - items.len();
    items.extend(std::iter::repeat_n(Item { at, text }, count.min(room)));
    Ok(())
}

/// Blanks are all control characters and the space.
fn is_blank(byte: u8) -> bool {
    byte <= b' '
}

fn is_line_end(byte: u8) -> bool {
    matches!(byte, b'\n' | b'\r')
}

fn blank(input: &[u8]) -> IResult<&[u8], usize> {
    many0_count(alt((take_while1(is_blank), comment))).parse(input)
}

fn comment(input: &[u8]) -> IResult<&[u8], &[u8]> {
    recognize((tag("--"), take_till(is_line_end))).parse(input)
}

fn token(input: &[u8]) -> IResult<&[u8], Token<'_>> {
    alt((
        value(Token::Slash, char('/')),
        quoted(b'\'').map(Token::Text),
        quoted(b'"').map(Token::Text),
        word.map(Token::Word),
    ))
    .parse(input)
}

fn quoted<'a>(
    quote: u8,
) -> impl Parser<&'a [u8], Output = &'a [u8], Error = nom::error::Error<&'a [u8]>> {
    let inside = take_till(move |byte| byte == quote || is_line_end(byte));
    delimited(char(quote.into()), inside, char(quote.into()))
}

/// Everything up to a blank, a `/`, a quote or a comment.
fn word(input: &[u8]) -> IResult<&[u8], &[u8]> {
    let length = token_end(input, 0);
    let quote = |byte: &u8| matches!(byte, b'\'' | b'"');
    let length = input[..length].iter().position(quote).unwrap_or(length);
    if length == 0 {
        return nom::combinator::fail().parse(input);
    }
    take(length).parse(input)
}

/// Splits `3*0.25` into count and word, `3*` and `*` into count and nothing; other words stand once.
pub(super) fn repeat(word: &[u8]) -> Result<(usize, &[u8]), Mistake> {
    if word == b"*" {
        return Ok((1, &word[1..]));
    }
    let counted: IResult<&[u8], (&[u8], &[u8])> =
        all_consuming((terminated(digit1, char('*')), rest)).parse(word);
    let Ok((_, (digits, written))) = counted else {
        return Ok((1, word));
    };
    let count = std::str::from_utf8(digits)
        .ok()
        .and_then(|digits| digits.parse::<usize>().ok())
        .filter(|&count| count > 0);
    count.map(|count| (count, written)).ok_or_else(|| {
        let word = shown(word);
        Mistake::new(
            ErrorKind::BadValue,
            0,
            format!("'{word}' has an impossible repeat count"),
        )
    })
}

/// The keyword at `at`, where that is the first visible byte of a line and the word looks like one.
pub(super) fn keyword(text: &[u8], at: usize) -> Option<Keyword> {
    let before = text
        .get(..at)?
        .iter()
        .rev()
        .find(|&&byte| !matches!(byte, b' ' | b'\t'));
    if before.is_some_and(|&byte| byte > b' ') {
        return None;
    }
    let behind = text.get(at..)?;
    let word = &behind[..token_end(behind, 0).min(LONGEST_KEYWORD + 1)];
    let spelled = word
        .iter()
        .all(|byte| byte.is_ascii_alphanumeric() || b"_+-&".contains(byte));
    let name = String::from_utf8_lossy(word).to_ascii_uppercase();
    let undefined = is_undefined(word);
    if !word.first()?.is_ascii_alphabetic() || !spelled || undefined || word.len() > LONGEST_KEYWORD
    {
        return None;
    }
    let end = at + word.len();
    let line = &text[end..line_end(text, end)];
    let follows = line.trim_ascii_start();
    // Lines drawn behind a keyword are decoration.
    let is_drawn = |byte: &u8| b"=-_#~".contains(byte) || byte.is_ascii_whitespace();
    let alone = follows.starts_with(b"--") || follows.iter().all(is_drawn);
    Some(Keyword {
        name,
        at,
        end,
        alone,
    })
}

/// The offset of the line end at or behind `at`, or of the end of the text.
pub(super) fn line_end(text: &[u8], at: usize) -> usize {
    let behind = text.get(at..).unwrap_or_default();
    behind
        .iter()
        .position(|&byte| is_line_end(byte))
        .map_or(text.len(), |length| at + length)
}

/// The offset behind the token at `at`: a blank, a `/`, a comment or the end of the text.
pub(super) fn token_end(text: &[u8], at: usize) -> usize {
    let behind = text.get(at..).unwrap_or_default();
    let ends = |(index, &byte): (usize, &u8)| {
        is_blank(byte) || byte == b'/' || (byte == b'-' && behind.get(index + 1) == Some(&b'-'))
    };
    behind
        .iter()
        .enumerate()
        .position(|pair| ends((pair.0, pair.1)))
        .map_or(text.len(), |length| at + length)
}

/// The offset of the `/` that ends the record open at `from`; `None` where the text ends first.
///
/// Looks for slashes first and only then whether one stands in a comment or in quotes: in the
/// arrays that make up a deck's bulk there is none before the end.
pub(super) fn record_end(text: &[u8], from: usize) -> Option<usize> {
    // Behind this offset neither a comment nor a quote is open.
    let mut clear = from;
    loop {
        let slash = clear + text.get(clear..)?.find_substring("/")?;
        match end_of_hiding(text, clear, slash) {
            None => return Some(slash),
            Some(end) => clear = end,
        }
    }
}

/// Where the comment or the quotes end in which `slash` stands, if it stands in any.
fn end_of_hiding(text: &[u8], clear: usize, slash: usize) -> Option<usize> {
    let line = text[clear..slash]
        .iter()
        .rposition(|&byte| is_line_end(byte));
    let mut at = line.map_or(clear, |index| clear + index + 1);
    while at < slash {
        let behind = &text[at..];
        if behind.starts_with(b"--") {
            return Some(line_end(text, slash));
        }
        let closed = alt((quoted(b'\''), quoted(b'"'))).parse(behind);
        at = closed.map_or(at + 1, |(rest, _)| text.len() - rest.len());
    }
    (at > slash).then_some(at)
}

/// A token for a message: its first 40 bytes.
pub(super) fn shown(token: &[u8]) -> String {
    String::from_utf8_lossy(&token[..token.len().min(40)]).into_owned()
}

/// Whether a token starts like a number, a repeat count or an undefined value.
pub(super) fn starts_number(text: &[u8]) -> bool {
    let word = &text[..token_end(text, 0)];
    let first = word.first().copied().unwrap_or_default();
    is_undefined(word) || first.is_ascii_digit() || b"+-.*".contains(&first)
}

/// Whether a token is a name for "no number", as some exporters write it.
pub(super) fn is_undefined(word: &[u8]) -> bool {
    let signed = matches!(word.first(), Some(b'-' | b'+'));
    let name = &word[usize::from(signed)..];
    [b"nan".as_slice(), b"inf", b"infinity"]
        .iter()
        .any(|undefined| name.eq_ignore_ascii_case(undefined))
}

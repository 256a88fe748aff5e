//! Tokens: the words and signs of Modelica (specification, section 2.3.3 and appendix A.1).
//! One macro makes the kinds, their spellings and the keyword table from one list.
//! Some signs are those of other languages (`&&`, `!=`, `**`): the parser recognises them to say what to write instead.

// Makes the kinds of tokens. The keywords must be in alphabetical order, by which `word_kind` finds them.
macro_rules! tokens {
    (keywords { $($keyword:ident $word:literal)* } signs { $($sign:ident $text:literal)* }) => {
        /// The kind of a token: a class of words (names, numbers, strings), one keyword or one sign.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub enum TokenKind {
            /// A name, plain or in single quotes.
            Ident,
            /// A number without point and exponent.
            Integer,
            /// A number with point or exponent.
            Real,
            /// A string, quotation marks included.
            String,
            /// A character that begins no token of Modelica.
            Unknown,
            /// The end of the text.
            Eof,
            $(#[doc = concat!("`", $word, "`")] $keyword,)*
            $(#[doc = concat!("`", $text, "`")] $sign,)*
        }

        /// The keywords in alphabetical order.
        const KEYWORDS: &[(&str, TokenKind)] = &[$(($word, TokenKind::$keyword),)*];

        impl TokenKind {
            /// The text of the token, if it is always the same. `None` for names, numbers, strings and the like.
            pub fn spelling(self) -> Option<&'static str> {
                match self {
                    $(TokenKind::$keyword => Some($word),)*
                    $(TokenKind::$sign => Some($text),)*
                    _ => None,
                }
            }

            /// True for reserved words, which cannot be names.
            pub fn is_keyword(self) -> bool {
                matches!(self, $(TokenKind::$keyword)|*)
            }

            /// True for the main keyword of a class, such as `model`.
            pub fn is_class_word(self) -> bool {
                use TokenKind as T;
                matches!(
                    self,
                    T::Class | T::Model | T::Block | T::Record | T::Connector | T::Type | T::Package | T::Function
                        | T::Operator
                )
            }

            /// True for prefixes that may stand before the keyword of a class or the type of a component.
            pub fn is_element_prefix(self) -> bool {
                use TokenKind as T;
                matches!(
                    self,
                    T::Final | T::Inner | T::Outer | T::Replaceable | T::Redeclare | T::Encapsulated | T::Partial
                        | T::Pure | T::Impure | T::Expandable
                )
            }
        }
    };
}

tokens! {
    keywords {
        Algorithm "algorithm" And "and" Annotation "annotation" Block "block" Break "break" Class "class"
        Connect "connect" Connector "connector" Constant "constant" Constrainedby "constrainedby" Der "der"
        Discrete "discrete" Each "each" Else "else" Elseif "elseif" Elsewhen "elsewhen" Encapsulated "encapsulated"
        End "end" Enumeration "enumeration" Equation "equation" Expandable "expandable" Extends "extends"
        External "external" False "false" Final "final" Flow "flow" For "for" Function "function" If "if"
        Import "import" Impure "impure" In "in" Initial "initial" Inner "inner" Input "input" Loop "loop"
        Model "model" Not "not" Operator "operator" Or "or" Outer "outer" Output "output" Package "package"
        Parameter "parameter" Partial "partial" Protected "protected" Public "public" Pure "pure" Record "record"
        Redeclare "redeclare" Replaceable "replaceable" Return "return" Stream "stream" Then "then" True "true"
        Type "type" When "when" While "while" Within "within"
    }
    signs {
        LeftParen "(" RightParen ")" LeftBracket "[" RightBracket "]" LeftBrace "{" RightBrace "}"
        Semicolon ";" Comma "," Dot "." Colon ":" Assign ":=" Equal "="
        EqualEqual "==" NotEqual "<>" Less "<" LessEqual "<=" Greater ">" GreaterEqual ">="
        Plus "+" Minus "-" Star "*" Slash "/" Caret "^"
        DotPlus ".+" DotMinus ".-" DotStar ".*" DotSlash "./" DotCaret ".^"
        AndAnd "&&" OrOr "||" Bang "!" BangEqual "!=" StarStar "**"
    }
}

/// For each letter the index of the first keyword that begins with it, and one past the last keyword at the end.
/// The keywords of letter `i` are those from `FIRST[i]` to `FIRST[i + 1]`.
const FIRST: [u8; 27] = {
    let mut first = [0; 27];
    let mut letter = 0;
    let mut i = 0;
    while letter < 27 {
        while i < KEYWORDS.len() && KEYWORDS[i].0.as_bytes()[0] - b'a' < letter {
            i += 1;
        }
        first[letter as usize] = i as u8;
        letter += 1;
    }
    first
};

/// The keyword that a word is, or `Ident`. A search among the keywords of one letter is short.
pub fn word_kind(word: &str) -> TokenKind {
    // All keywords begin with a small letter.
    let letter = match word.as_bytes().first() {
        Some(b @ b'a'..=b'z') => usize::from(b - b'a'),
        _ => return TokenKind::Ident,
    };
    let candidates = &KEYWORDS[usize::from(FIRST[letter])..usize::from(FIRST[letter + 1])];
    candidates.iter().find(|(keyword, _)| *keyword == word).map_or(TokenKind::Ident, |&(_, kind)| kind)
}

/// A token: its kind, and the bytes of the text that it covers.
#[derive(Clone, Copy, Debug)]
pub struct Token {
    /// What it is.
    pub kind: TokenKind,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_keyword_is_found() {
        assert!(KEYWORDS.is_sorted_by_key(|(word, _)| *word));
        for &(word, kind) in KEYWORDS {
            assert_eq!(word_kind(word), kind);
            assert_eq!(kind.spelling(), Some(word));
            assert!(kind.is_keyword());
        }
        for word in ["", "x", "ende", "en", "Model", "zero", "_if", "ä"] {
            assert_eq!(word_kind(word), TokenKind::Ident);
        }
    }
}

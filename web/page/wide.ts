// From which width on the page has two columns, as in style/base.css: there is room to show more at once.

export const WIDE = "(min-width: 62rem)";

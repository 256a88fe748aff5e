//! model M
//! c.re(1) = 4
//! c.im(1) = 3
//! d.re(1) = -2
//! p.re(1) = 0
//! p.im(1) = 5
//! f[2].re(1) = 3
package P
  operator record Complex
    Real re;
    Real im;
    encapsulated operator 'constructor'
      function fromReal
        import P.Complex;
        input Real re;
        input Real im = 0;
        output Complex result(re = re, im = im);
      algorithm
      end fromReal;
    end 'constructor';
    encapsulated operator '-'
      function negate
        import P.Complex;
        input Complex a;
        output Complex b;
      algorithm
        b := Complex(-a.re, -a.im);
      end negate;
      function subtract
        import P.Complex;
        input Complex a, b;
        output Complex c;
      algorithm
        c := Complex(a.re - b.re, a.im - b.im);
      end subtract;
    end '-';
    encapsulated operator function '+'
      import P.Complex;
      input Complex a, b;
      output Complex c;
    algorithm
      c := Complex(a.re + b.re, a.im + b.im);
    end '+';
    encapsulated operator function '*'
      import P.Complex;
      input Complex a, b;
      output Complex c;
    algorithm
      c := Complex(a.re*b.re - a.im*b.im, a.re*b.im + a.im*b.re);
    end '*';
  end Complex;
end P;
model M
  import P.Complex;
  Complex a = Complex(2, 1);
  Complex b = Complex(1, 2);
  Complex c = a + b + 1 - Complex(0);
  Complex d = -a;
  Complex p = a*b;
  Complex e[2] = {a, b};
  Complex f[2] = e + {b, a};
end M;

//! model P.M
//! c.re(0.17) = 0.942754665528
//! c.re(0.63) = 0.305816908378
//! c.im(0.17) = 0.333487092141
//! c.im(0.63) = 0.952090341591
//! d[2].re(0.17) = 4.92792383455
//! d[2].re(0.63) = 4.04013754156
//! s(0.17) = 1.15476711598
//! s(0.63) = 1.39717226625
//! n(0.89) = 3
//! q.a[2](0.17) = 0.34
//! q.a[2](0.63) = 1.26
//! q.b.re(0.17) = 0.17
//! q.b.re(0.63) = 0.63
package P
  record C
    Real re;
    Real im;
  end C;
  record Q
    Real a[2];
    C b;
    Integer n = 3;
  end Q;
  function mul
    input C a;
    input C b;
    output C c;
  algorithm
    c := C(a.re*b.re - a.im*b.im, a.re*b.im + a.im*b.re);
  end mul;
  function scale
    input C v[:];
    input Real k;
    output C w[size(v, 1)];
  algorithm
    for i in 1:size(v, 1) loop
      w[i].re := k*v[i].re;
      w[i].im := k*v[i].im;
    end for;
  end scale;
  function addto
    input Q q;
    output Q r = q;
  algorithm
    r.a[1] := r.a[1] + 9;
    r.b.im := 4;
  end addto;
  model M
    C e = C(re = cos(time), im = sin(time));
    C c = mul(e, e);
    C d[2] = scale({C(1, 0), e}, 5);
    Real s = sum({e.re, e.im});
    Q q(a = {time, 2*time}, b(re = time, im = 0));
    Integer n = q.n;
    parameter Q p(a = {1, 7}, b = C(2, 3));
    parameter Q r2 = addto(p);
  end M;
end P;
